// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/obj_reader.h"

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
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::uint32_t kNone = kInvalidIndex;
constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class ObjReader : public testing::Test {
 protected:
  ObjFile read(std::string_view text) {
    ObjFile file = read_obj(write_file(folder_ / "mesh.obj", text));
    file.soup.validate();
    return file;
  }
  std::string error(std::string_view text) {
    return input_error_of([&] { read(text); });
  }
  TempDir folder_;
};

TEST_F(ObjReader, ReadsATriangle) {
  const ObjFile file = read("v 0 0 0\nv 1.5 -2e-3 +.25\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(file.soup.positions, ElementsAre(Vec3(0, 0, 0), Vec3(1.5, -2e-3, 0.25), Vec3(0, 1, 0)));
  EXPECT_THAT(file.soup.face_positions(0), ElementsAre(0, 1, 2));
  EXPECT_EQ(file.soup.face_count(), 1u);
  EXPECT_THAT(file.soup.corner_uv, IsEmpty());
  EXPECT_THAT(file.soup.corner_normal, IsEmpty());
  EXPECT_THAT(file.soup.face_material, IsEmpty());
  EXPECT_THAT(file.material_names, ElementsAre(""));
  EXPECT_THAT(file.warnings, IsEmpty());
  EXPECT_THAT(file.soup.source, EndsWith("mesh.obj"));
}

TEST_F(ObjReader, ReadsEveryCornerFormInOneFile) {
  const ObjFile file = read(std::string(kTriangle) +
                            "vt 0.25\nvt 0.5 0.75\nvt 0 1 9\nvn 0 0 2\nvn 3 0 4\n"
                            "f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//2 3//1\nf 1/3/2 2/2/1 3/1/2\nf 1/ 2// 3\n");
  const PolygonSoup& soup = file.soup;
  EXPECT_EQ(soup.face_count(), 5u);
  EXPECT_THAT(soup.uvs, ElementsAre(Vec2(0.25, 0), Vec2(0.5, 0.75), Vec2(0, 1)));
  EXPECT_THAT(soup.normals, ElementsAre(Vec3(0, 0, 1), Vec3(0.6, 0, 0.8)));
  EXPECT_THAT(soup.corner_uv,
              ElementsAre(kNone, kNone, kNone, 0, 1, 2, kNone, kNone, kNone, 2, 1, 0, kNone, kNone, kNone));
  EXPECT_THAT(soup.corner_normal,
              ElementsAre(kNone, kNone, kNone, kNone, kNone, kNone, 0, 1, 0, 1, 0, 1, kNone, kNone, kNone));
}

TEST_F(ObjReader, NegativeIndicesCountBackFromTheirLine) {
  const ObjFile file =
      read(std::string(kTriangle) + "f -3 -2 -1\nv 5 5 5\nvn 1 0 0\nf -3//-1 -2//-1 -1//-1\n");
  EXPECT_THAT(file.soup.face_positions(0), ElementsAre(0, 1, 2));
  EXPECT_THAT(file.soup.face_positions(1), ElementsAre(1, 2, 3));
}

TEST_F(ObjReader, PositiveIndicesMayPointForward) {
  const ObjFile file = read(std::string("f 1//1 2//1 3//1\n") + kTriangle + "vn 0 1 0\n");
  EXPECT_THAT(file.soup.face_positions(0), ElementsAre(0, 1, 2));
}

TEST_F(ObjReader, ReadsPolygonsOfAnySize) {
  std::string text;
  std::string face = "f";
  for (int i = 1; i <= 300; ++i) {
    text += fmt::format("v {} {} 0\n", i, i * i);
    face += fmt::format(" {}", i);
  }
  const ObjFile file = read(text + face);  // Without a line break at the end.
  EXPECT_THAT(file.soup.face_positions(0), SizeIs(300));
}

TEST_F(ObjReader, AcceptsTheFreedomsOfTheSyntax) {
  const ObjFile file = read(
      "\xEF\xBB\xBF# comment with a trailing backslash \\\r\n"
      "\r\n"
      "o thing\r\ng a b\r\ns off\r\nmg 1 0.5\r\n"
      "v\t0  0 0 1.0 # with weight\r\n"
      "  v 1 0 0 0.5 0.5 0.5\r\n"
      "v 0 1 \\\r\n 0 1 0.1 0.2 0.3\r\n"
      "v 0 1e-400 1\r\n"
      "f 1 2\\\n3 # the end\r\n"
      "fo 1 \\\n\\\n 3 4");
  EXPECT_THAT(file.soup.positions, ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)));
  EXPECT_THAT(file.soup.corner_position, ElementsAre(0, 1, 2, 0, 2, 3));
  EXPECT_THAT(file.warnings, IsEmpty());
}

TEST_F(ObjReader, KeepsDegenerateFaces) {
  EXPECT_THAT(read(std::string(kTriangle) + "f 1 1 2\n").soup.face_positions(0), ElementsAre(0, 0, 1));
}

TEST_F(ObjReader, NumbersMaterialsByFirstUse) {
  const ObjFile file = read(std::string(kTriangle) +
                            "f 1 2 3\nusemtl never used\nusemtl red paint # 2\nf 1 2 3\nusemtl b#1\nf 1 2 3\n"
                            "usemtl red paint\nf 1 2 3\n");
  EXPECT_THAT(file.material_names, ElementsAre("", "red paint", "b#1"));
  EXPECT_THAT(file.soup.face_material, ElementsAre(0, 1, 2, 1));
}

TEST_F(ObjReader, OneMaterialNeedsNoFaceList) {
  const ObjFile file = read(std::string(kTriangle) + "usemtl only\nf 1 2 3\nf 3 2 1\n");
  EXPECT_THAT(file.material_names, ElementsAre("only"));
  EXPECT_THAT(file.soup.face_material, IsEmpty());
}

TEST_F(ObjReader, FindsMaterialLibraries) {
  write_file(folder_ / "two words.mtl", "newmtl a\n");
  write_file(folder_ / "a.mtl", "newmtl a\n");
  write_file(folder_ / "b.mtl", "newmtl b\n");
  const std::string faces = std::string(kTriangle) + "f 1 2 3\n";
  const auto libraries = [&](const std::string& line) {
    return read(line + "\n" + faces).material_libraries;
  };
  EXPECT_THAT(libraries("mtllib a.mtl b.mtl"), ElementsAre(folder_ / "a.mtl", folder_ / "b.mtl"));
  EXPECT_THAT(libraries("mtllib a.mtl \\\n b.mtl"), ElementsAre(folder_ / "a.mtl", folder_ / "b.mtl"));
  EXPECT_THAT(libraries("mtllib two words.mtl # x"), ElementsAre(folder_ / "two words.mtl"));
  EXPECT_THAT(libraries("mtllib missing.mtl"), ElementsAre(folder_ / "missing.mtl"));
  EXPECT_THAT(libraries("mtllib no such.mtl"), ElementsAre(folder_ / "no", folder_ / "such.mtl"));
  EXPECT_THAT(libraries("mtllib a.mtl\nmtllib a.mtl"), ElementsAre(folder_ / "a.mtl"));
}

TEST_F(ObjReader, WarnsOnceOfEachKindLeftOut) {
  const ObjFile file = read(std::string(kTriangle) +
                            "p 1\np 2 3\nl 1 2\ncstype bezier\ndeg 3\ncurv 0 1 1 2\nend\nf 1 2 3\nl 2 3\n");
  EXPECT_THAT(file.warnings, testing::UnorderedElementsAre(
                                 HasSubstr("mesh.obj:4: points ('p') are left out (2 statements)"),
                                 HasSubstr("mesh.obj:6: lines ('l') are left out (2 statements)"),
                                 HasSubstr("mesh.obj:7: free-form curves and surfaces are left out (4")));
}

TEST_F(ObjReader, ZeroNormalsAreAbsent) {
  const ObjFile file =
      read(std::string(kTriangle) +
           "vn 0 0 0\nvn 0 3 0\nvn 0 0 -0\nvn 1e-200 0 0\nf 1//1 2//2 3//4\nf 1//3 2//2 3//2\n");
  EXPECT_THAT(file.soup.normals, ElementsAre(Vec3(0, 1, 0), Vec3(1, 0, 0)));
  EXPECT_THAT(file.soup.corner_normal, ElementsAre(kNone, 0, 1, kNone, 0, 0));
  EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("mesh.obj:4: zero normals are taken as absent (2 'vn')")));
}

TEST_F(ObjReader, NamesLineAndFaultOfMalformedFiles) {
  struct Case {
    const char* rest;  // After the three lines of kTriangle.
    std::size_t line;
    const char* message;
  };
  const std::vector<Case> cases{
      {"v 1 2\nf 1 2 3", 4, "'v' with 2 numbers; write 'v x y z'"},
      {"v\nf 1 2 3", 4, "'v' with 0 numbers"},
      {"v 1 2 3 4 5\nf 1 2 3", 4, "'v' with 5 numbers"},
      {"v 1 2 3 4 5 6 7 8 9\nf 1 2 3", 4, "too many numbers"},
      {"v 1 2 abc\nf 1 2 3", 4, "'abc' is not a number"},
      {"v 1 2 3,5\nf 1 2 3", 4, "'3,5' is not a number"},
      {"v 1 2 0x10\nf 1 2 3", 4, "'0x10' is not a number"},
      {"v 1 2 3#c\nf 1 2 3", 4, "'3#c' is not a number"},
      {"v 1 +-2 3\nf 1 2 3", 4, "'+-2' is not a number"},
      {"f 1 2 3\nv 1 nan 3", 5, "'nan' is not a finite number"},
      {"f 1 2 3\nv 1 -inf 3", 5, "'-inf' is not a finite number"},
      {"f 1 2 3\nv 1 1e999 3", 5, "'1e999' is not a finite number"},
      {"f 1 2 3\n\n\nv 1 2e18 3", 7, "further out than 1e18"},
      {"vn 0 0\nf 1 2 3", 4, "'vn' with 2 numbers"},
      {"vn 0 0 nan\nf 1 2 3", 4, "'nan' is not a finite number"},
      {"vt\nf 1 2 3", 4, "'vt' with 0 numbers"},
      {"vt 0 0 0 0\nf 1 2 3", 4, "'vt' with 4 numbers"},
      {"vt inf 0\nf 1 2 3", 4, "'inf' is not a finite number"},
      {"f 1 2", 4, "'f' with 2 corners; a face needs at least 3"},
      {"f 1 2 # 3", 4, "'f' with 2 corners"},
      {"f", 4, "'f' with 0 corners"},
      {"# c\n\nf 1 2 4", 6, "vertex 4, but the file has 3 ('v')"},
      {"f 1 2 3\nf 1 2 \\\n\\\n9\nf 1 2 3", 7, "vertex 9, but the file has 3"},
      {"f 1 2 0", 4, "'0' has an index 0"},
      {"vn 0 0 1\nf 1//1 2//0 3//1", 5, "'2//0' has an index 0"},
      {"f 1 2 -4", 4, "'-4' refers to a vertex that does not exist (there are 3 so far)"},
      {"f 1/1 2/1 3/1", 4, "texture coordinate 1, but the file has 0 ('vt')"},
      {"vn 0 0 1\nf 1//1 2//1 3//2", 5, "normal 2, but the file has 1 ('vn')"},
      {"vt 0 0\nf 1/-2 2/1 3/1", 5, "'1/-2' refers to a texture coordinate"},
      {"f 1 2 4294967296", 4, "'4294967296' refers to a vertex that does not exist"},
      {"f 1 2 99999999999999999999", 4, "'99999999999999999999' refers to a vertex"},
      {"f 1 2 3x", 4, "'3x' is not a corner of a face"},
      {"f 1 2 1.5", 4, "'1.5' is not a corner of a face"},
      {"f 1 2 /1", 4, "'/1' is not a corner of a face"},
      {"f 1 2 1/2/3/4", 4, "'1/2/3/4' is not a corner of a face"},
      {"f 1 2 nan", 4, "'nan' is not a corner of a face"},
      {"mtllib\nf 1 2 3", 4, "'mtllib' without a file name"},
      {"f 1 2 3\nvertex 1 2 3", 5, "'vertex' is not a statement of OBJ"},
      {"f 1 2 3\n\x01\x80garbage", 5, "'\\x01\\x80garbage' is not a statement of OBJ"},
  };
  for (const Case& c : cases) {
    const std::string message = error(std::string(kTriangle) + c.rest);
    EXPECT_THAT(message, HasSubstr(fmt::format("mesh.obj:{}: ", c.line))) << c.rest;
    EXPECT_THAT(message, HasSubstr(c.message)) << c.rest;
  }
}

TEST_F(ObjReader, RefusesFilesWithoutASurface) {
  EXPECT_THAT(error(kTriangle), HasSubstr("mesh.obj: no faces"));
  EXPECT_THAT(error("v 0 0 0\np 1\n"), HasSubstr("no faces"));
  EXPECT_THAT(error("\n\n# nothing\n"), HasSubstr("no faces"));
  EXPECT_THAT(error(""), HasSubstr("the file is empty"));
  EXPECT_THAT(input_error_of([&] { static_cast<void>(read_obj(folder_ / "none.obj")); }),
              HasSubstr("none.obj: the file does not exist"));
  EXPECT_THAT(input_error_of([&] { static_cast<void>(read_obj(folder_.path())); }),
              HasSubstr("this is a folder"));
}

TEST_F(ObjReader, SurvivesDamagedFiles) {
  const std::string text = std::string("mtllib a.mtl\n") + kTriangle +
                           "v 1 1 0.5\nvt 0 0\nvt 1 1\nvn 0 0 1\nvn 0 0 0\nusemtl m\n"
                           "f 1/1/1 2/2/1 3/1/2\nf -3//-1 -1//-2 \\\n 3\ng part\nl 1 2\nf 1/2 2/1 4/2 3/1\n";
  const int rounds = 4000;
  const int accepted = test::count_accepted_mutations(
      text, rounds, 11, [](const auto& path) { read_obj(path).soup.validate(); });
  EXPECT_GT(accepted, rounds / 50);
  EXPECT_LT(accepted, rounds * 9 / 10);
}

}  // namespace
}  // namespace vrc
