// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mtl_reader.h"

#include <string>
#include <string_view>
#include <vector>

#include "reader_support.h"

namespace vrc {
namespace {

using test::input_error_of;
using test::TempDir;
using test::write_file;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MtlReader : public testing::Test {
 protected:
  std::vector<MtlMaterial> read(std::string_view text) {
    return read_mtl(write_file(folder_ / "a.mtl", text));
  }
  std::string error(std::string_view text) {
    return input_error_of([&] { read(text); });
  }
  TempDir folder_;
};

void expect_rgb(const Rgb& actual, const Rgb& expected) { EXPECT_TRUE((actual == expected).all()) << actual; }

TEST_F(MtlReader, ReadsAllStatementsOfAMaterial) {
  const auto materials = read(
      "\xEF\xBB\xBF# head\r\nnewmtl red paint # 2\r\n\tKd 0.8 .1 0.05\r\nKs 0.25\r\nKe 10 20 1e3\r\nNs "
      "96.5\r\n"
      "Pr 0.5\r\nPm 1\r\nNi 1.5\r\nd 1\r\nTr 0\r\nillum 2\r\nKa spectral x.rfl\r\nTf xyz 1 1 1\r\n\r\n"
      "newmtl plain");
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[0].name, "red paint");
  expect_rgb(materials[0].diffuse, Rgb(0.8f, 0.1f, 0.05f));
  expect_rgb(materials[0].specular, Rgb(0.25f, 0.25f, 0.25f));
  expect_rgb(materials[0].emission, Rgb(10.0f, 20.0f, 1000.0f));
  EXPECT_EQ(materials[0].shininess, 96.5f);
  EXPECT_EQ(materials[0].roughness, 0.5f);
  EXPECT_EQ(materials[0].metallic, 1.0f);
  EXPECT_THAT(materials[0].textures, IsEmpty());

  EXPECT_EQ(materials[1].name, "plain");
  expect_rgb(materials[1].diffuse, Rgb(0.5f, 0.5f, 0.5f));
  expect_rgb(materials[1].specular, Rgb::Zero());
  expect_rgb(materials[1].emission, Rgb::Zero());
  EXPECT_FALSE(materials[1].roughness.has_value());
  EXPECT_FALSE(materials[1].metallic.has_value());
}

TEST_F(MtlReader, CollectsTextureNamesWithoutOptions) {
  const auto materials = read(
      "newmtl a\nmap_Kd wood.png\nmap_Ks -s 1 1 1 -o 0.5 -blendu on my stone.tga\n"
      "map_Bump -bm 0.3 -mm 0 1 -imfchan r -clamp on bump map.png # c\nmap_d -t 1 2 3 4.png\n");
  ASSERT_EQ(materials.size(), 1u);
  EXPECT_THAT(materials[0].textures, ElementsAre("wood.png", "my stone.tga", "bump map.png", "4.png"));
}

TEST_F(MtlReader, AFileWithoutMaterialsIsEmpty) { EXPECT_THAT(read("# nothing here\n"), IsEmpty()); }

TEST_F(MtlReader, NamesLineAndFaultOfMalformedStatements) {
  struct Case {
    const char* rest;  // After "newmtl a\n".
    std::size_t line;
    const char* message;
  };
  const std::vector<Case> cases{
      {"Kd 1 1", 2, "'Kd' with 2 numbers; write 'Kd r g b'"},
      {"Kd", 2, "'Kd' with 0 numbers"},
      {"Kd 1 1 1 1", 2, "'Kd' with more than 3 numbers"},
      {"\nKd 1 x 1", 3, "'x' is not a number"},
      {"Kd 1 -0.5 1", 2, "'Kd' is -0.5; give a value of at least 0"},
      {"Kd nan 1 1", 2, "'nan' is not a finite number"},
      {"Ke 1e39 1 1", 2, "'Ke' is 1e+39"},
      {"Kd spectral file.rfl 1", 2, "'Kd spectral' is not supported; write 'Kd r g b'"},
      {"Ks xyz 1 1 1", 2, "'Ks xyz' is not supported"},
      {"Ns", 2, "'Ns' without a number"},
      {"Ns -1", 2, "'Ns' is -1; give a value of at least 0"},
      {"Ns 1 2", 2, "'2' after the value of 'Ns'"},
      {"Ns inf", 2, "'inf' is not a finite number"},
      {"Pr 1.5", 2, "'Pr' is 1.5; give a value from 0 to 1"},
      {"Pm -0.1", 2, "'Pm' is -0.1; give a value from 0 to 1"},
      {"newmtl", 2, "'newmtl' without a name"},
      {"map_Kd", 2, "'map_Kd' without a file name"},
      {"map_Kd -s 1 1 1", 2, "'map_Kd' without a file name"},
  };
  for (const Case& c : cases) {
    const std::string message = error(std::string("newmtl a\n") + c.rest + "\n");
    EXPECT_THAT(message, HasSubstr(fmt::format("a.mtl:{}: ", c.line))) << c.rest;
    EXPECT_THAT(message, HasSubstr(c.message)) << c.rest;
  }
  EXPECT_THAT(error("# c\nKd 1 1 1\n"), HasSubstr("a.mtl:2: 'Kd' before the first 'newmtl'"));
}

TEST_F(MtlReader, RefusesMissingAndEmptyFiles) {
  EXPECT_THAT(error(""), HasSubstr("the file is empty"));
  EXPECT_THAT(input_error_of([&] { static_cast<void>(read_mtl(folder_ / "none.mtl")); }),
              HasSubstr("the file does not exist"));
  EXPECT_THAT(input_error_of([&] { static_cast<void>(read_mtl(folder_.path())); }),
              HasSubstr("this is a folder"));
}

TEST_F(MtlReader, SurvivesDamagedFiles) {
  const std::string text =
      "newmtl a\nKd 0.1 0.2 0.3\nKs 1\nKe 1 2 3\nNs 10\nPr 0.5\nPm 0\nmap_Kd -s 1 1 1 a b.png\nillum 2\n"
      "newmtl b\nKd 1 1 1\n";
  const auto read_and_check = [](const auto& path) {
    for (const MtlMaterial& m : read_mtl(path)) {
      EXPECT_FALSE(m.name.empty());
      for (const Rgb& color : {m.diffuse, m.specular, m.emission}) {
        EXPECT_TRUE(color.allFinite() && (color >= 0.0f).all());
      }
      EXPECT_TRUE(m.shininess >= 0.0f && m.roughness.value_or(0.0f) <= 1.0f &&
                  m.metallic.value_or(0.0f) <= 1.0f);
    }
  };
  const int rounds = 3000;
  const int accepted = test::count_accepted_mutations(text, rounds, 12, read_and_check);
  EXPECT_GT(accepted, rounds / 50);
  EXPECT_LT(accepted, rounds * 9 / 10);
}

}  // namespace
}  // namespace vrc
