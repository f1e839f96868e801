// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ply_reader.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
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

// Writes values into a body in one of the three formats.
class BodyWriter {
 public:
  explicit BodyWriter(std::string format) : format_(std::move(format)) {}

  BodyWriter& put(std::string_view type, double value) {
    if (format_ == "ascii") {
      body_ += fmt::format("{}{}", row_begins_ ? "" : " ", value);
      row_begins_ = false;
    } else if (type == "char" || type == "int8") {
      append(static_cast<std::int8_t>(value));
    } else if (type == "uchar" || type == "uint8") {
      append(static_cast<std::uint8_t>(value));
    } else if (type == "short" || type == "int16") {
      append(static_cast<std::int16_t>(value));
    } else if (type == "ushort" || type == "uint16") {
      append(static_cast<std::uint16_t>(value));
    } else if (type == "int" || type == "int32") {
      append(static_cast<std::int32_t>(value));
    } else if (type == "uint" || type == "uint32") {
      append(static_cast<std::uint32_t>(value));
    } else if (type == "float" || type == "float32") {
      append(static_cast<float>(value));
    } else {
      append(value);
    }
    return *this;
  }
  BodyWriter& list(std::string_view count_type, std::string_view type, const std::vector<double>& values) {
    put(count_type, static_cast<double>(values.size()));
    for (const double value : values) put(type, value);
    return *this;
  }
  BodyWriter& end_row() {
    if (format_ == "ascii") body_ += '\n';
    row_begins_ = true;
    return *this;
  }
  // The whole file; `header` is what stands between the format and the end.
  [[nodiscard]] std::string file(const std::string& header) const {
    return "ply\nformat " + format_ + " 1.0\n" + header + "end_header\n" + body_;
  }
  [[nodiscard]] const std::string& format() const { return format_; }

 private:
  template <typename Value>
  void append(Value value) {
    char bytes[sizeof(Value)];
    std::memcpy(bytes, &value, sizeof(Value));
    const bool little = format_ == "binary_little_endian";
    if (little != (std::endian::native == std::endian::little)) std::reverse(bytes, bytes + sizeof(Value));
    body_.append(bytes, sizeof(Value));
  }

  std::string format_;
  std::string body_;
  bool row_begins_ = true;
};

const std::vector<std::string> kFormats{"ascii", "binary_little_endian", "binary_big_endian"};

constexpr const char* kXyz = "property float x\nproperty float y\nproperty float z\n";
constexpr const char* kFace = "property list uchar int vertex_indices\n";

std::string header(int vertices, int faces) {
  return fmt::format("element vertex {}\n{}element face {}\n{}", vertices, kXyz, faces, kFace);
}

BodyWriter square(const std::string& format) {
  BodyWriter body(format);
  for (const Vec2& p : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
    body.put("float", p[0]).put("float", p[1]).put("float", 0.5).end_row();
  }
  return body;
}

std::string square_file(const std::string& format) {
  BodyWriter body = square(format);
  body.list("uchar", "int", {0, 1, 2, 3}).end_row();
  body.list("uchar", "int", {2, 1, 0}).end_row();
  return body.file(header(4, 2));
}

class PlyReader : public testing::Test {
 protected:
  PolygonSoup read(std::string_view text) {
    PolygonSoup soup = read_ply(write_file(folder_ / "mesh.ply", text));
    soup.validate();
    return soup;
  }
  std::string error(std::string_view text) {
    return input_error_of([&] { read(text); });
  }
  TempDir folder_;
};

TEST_F(PlyReader, ReadsTheSameMeshInEveryFormat) {
  for (const std::string& format : kFormats) {
    const PolygonSoup soup = read(square_file(format));
    EXPECT_THAT(soup.positions,
                ElementsAre(Vec3(0, 0, 0.5), Vec3(1, 0, 0.5), Vec3(1, 1, 0.5), Vec3(0, 1, 0.5)))
        << format;
    EXPECT_THAT(soup.face_positions(0), ElementsAre(0, 1, 2, 3)) << format;
    EXPECT_THAT(soup.face_positions(1), ElementsAre(2, 1, 0)) << format;
    EXPECT_THAT(soup.corner_normal, IsEmpty());
    EXPECT_THAT(soup.corner_uv, IsEmpty());
  }
}

TEST_F(PlyReader, ReadsEveryScalarType) {
  for (const std::string& format : kFormats) {
    for (const std::string_view type :
         {"char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32", "uint",
          "uint32", "float", "float32", "double", "float64"}) {
      BodyWriter body(format);
      for (const double x : {0.0, 100.0, 7.0}) body.put(type, x).put(type, 1).put(type, 2).end_row();
      body.list("uchar", "int", {0, 1, 2}).end_row();
      const PolygonSoup soup = read(body.file(
          fmt::format("element vertex 3\nproperty {0} x\nproperty {0} y\nproperty {0} z\nelement face 1\n{1}",
                      type, kFace)));
      EXPECT_THAT(soup.positions, ElementsAre(Vec3(0, 1, 2), Vec3(100, 1, 2), Vec3(7, 1, 2)))
          << format << type;
    }
  }
}

TEST_F(PlyReader, ReadsEveryIntegerTypeOfListsAndBothSpellings) {
  for (const std::string& format : kFormats) {
    for (const std::string type : {"char", "uchar", "short", "ushort", "int", "uint"}) {
      for (const std::string name : {"vertex_index", "vertex_indices"}) {
        BodyWriter body = square(format);
        body.list(type, type, {3, 2, 1}).end_row();
        const PolygonSoup soup = read(body.file(fmt::format(
            "element vertex 4\n{}element face 1\nproperty list {} {} {}\n", kXyz, type, type, name)));
        EXPECT_THAT(soup.face_positions(0), ElementsAre(3, 2, 1)) << format << type;
      }
    }
  }
}

TEST_F(PlyReader, DoublesKeepAllDigits) {
  const double x = 0.1234567890123456789;
  for (const std::string& format : kFormats) {
    BodyWriter body(format);
    for (int i = 0; i < 3; ++i) body.put("double", x).put("double", -1e17 * i).put("double", 0).end_row();
    body.list("uchar", "int", {0, 1, 2}).end_row();
    const PolygonSoup soup = read(body.file(
        std::string(
            "element vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face 1\n") +
        kFace));
    EXPECT_EQ(soup.positions[2], Vec3(x, -2e17, 0)) << format;
  }
}

TEST_F(PlyReader, SkipsWhatItDoesNotKnowInAnyOrder) {
  for (const std::string& format : kFormats) {
    BodyWriter body(format);
    body.list("uint", "double", {1, 2, 3}).put("short", 4).end_row();  // camera, before everything
    body.put("uchar", 9).list("uchar", "short", {0, 1, 2}).list("uchar", "float", {}).end_row();
    body.put("uchar", 9).list("uchar", "short", {2, 1, 3}).list("uchar", "float", {0.5, 7}).end_row();
    for (int i = 0; i < 4; ++i) {  // vertices after the faces, z first
      body.put("float", i)
          .put("uchar", 200)
          .list("char", "int", {1})
          .put("float", i * i)
          .put("float", 1)
          .end_row();
    }
    body.put("int", 0).put("int", 1).end_row();  // edge
    const PolygonSoup soup =
        read(body.file("comment made by hand\nobj_info any words here\n"
                       "element camera 1\nproperty list uint double view\nproperty short id\n"
                       "element face 2\nproperty uchar flags\nproperty list uchar short vertex_indices\n"
                       "property list uchar float weights\nelement marker 5\n"
                       "element vertex 4\nproperty float z\nproperty uchar red\nproperty list char int "
                       "tags\nproperty float x\n"
                       "property float y\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"));
    EXPECT_THAT(soup.positions, ElementsAre(Vec3(0, 1, 0), Vec3(1, 1, 1), Vec3(4, 1, 2), Vec3(9, 1, 3)))
        << format;
    EXPECT_THAT(soup.corner_position, ElementsAre(0, 1, 2, 2, 1, 3)) << format;
  }
}

TEST_F(PlyReader, ReadsNormalsAndTextureCoordinates) {
  for (const auto& [u, v] : {std::pair("u", "v"), std::pair("s", "t"), std::pair("texture_u", "texture_v")}) {
    for (const std::string& format : kFormats) {
      BodyWriter body(format);
      for (int i = 0; i < 3; ++i) {
        body.put("float", i).put("float", i * i).put("float", 0);
        body.put("float", 0).put("float", 0).put("float", i == 1 ? 0 : 5);
        body.put("float", 0.25 * i).put("float", 0.5).end_row();
      }
      body.list("uchar", "int", {2, 1, 0}).end_row();
      const PolygonSoup soup = read(body.file(
          fmt::format("element vertex 3\n{}property float nx\nproperty float ny\nproperty float nz\n"
                      "property float {}\nproperty float {}\nelement face 1\n{}",
                      kXyz, u, v, kFace)));
      EXPECT_THAT(soup.normals, ElementsAre(Vec3(0, 0, 1), Vec3(0, 0, 1)));
      EXPECT_THAT(soup.corner_normal, ElementsAre(1, kInvalidIndex, 0));  // A zero normal is absent.
      EXPECT_THAT(soup.uvs, ElementsAre(Vec2(0, 0.5), Vec2(0.25, 0.5), Vec2(0.5, 0.5)));
      EXPECT_THAT(soup.corner_uv, ElementsAre(2, 1, 0));
    }
  }
}

TEST_F(PlyReader, UnfoldsTriangleStrips) {
  for (const std::string& format : kFormats) {
    BodyWriter body(format);
    for (int i = 0; i < 6; ++i) body.put("float", i).put("float", i % 2).put("float", 0).end_row();
    body.list("int", "int", {0, 1, 2, 3, -1, 2, 3, 4, 4, 5, -1, 0, 1, -1, -1, 3, 4, 5}).end_row();
    const PolygonSoup soup = read(body.file(fmt::format(
        "element vertex 6\n{}element tristrips 1\nproperty list int int vertex_indices\n", kXyz)));
    EXPECT_THAT(soup.corner_position, ElementsAre(0, 1, 2, 2, 1, 3, 2, 3, 4, 3, 4, 5)) << format;
    EXPECT_EQ(soup.face_count(), 4u);
  }
}

TEST_F(PlyReader, AcceptsWindowsLineEndsAndBlankLines) {
  const PolygonSoup soup = read(
      "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\n"
      "property float z\r\nelement face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n"
      "0 0 0\r\n\r\n  1\t0 0  \r\n0 1 0\r\n3 0 1 2\r\n\r\n  \r\n");
  EXPECT_EQ(soup.face_count(), 1u);
  std::string binary = square_file("binary_little_endian");
  const std::size_t body = binary.find("end_header\n") + 11;
  std::string head;
  for (const char c : binary.substr(0, body)) head += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(read(head + binary.substr(body)).face_count(), 2u);
}

TEST_F(PlyReader, NamesLineAndFaultOfMalformedHeaders) {
  struct Case {
    const char* text;
    std::size_t line;
    const char* message;
  };
  const std::vector<Case> cases{
      {"plyx\n", 1, "the first line is not 'ply'"},
      {"\x80\x81\n", 1, "the first line is not 'ply'"},
      {"ply\nformat text 1.0\nend_header\n", 2, "'text' is not a format"},
      {"ply\nformat ascii 2.0\nend_header\n", 2, "'2.0' is not a known version"},
      {"ply\nend_header\n", 2, "no 'format'"},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n", 5, "no 'end_header'"},
      {"ply\nformat ascii 1.0\nelement vertex three\n", 3, "'three' is not a number of 'vertex' elements"},
      {"ply\nformat ascii 1.0\nelement vertex -3\n", 3, "'-3' is not a number of 'vertex'"},
      {"ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n", 3, "is not a number of 'vertex'"},
      {"ply\nformat ascii 1.0\nelement\n", 3, "name of the element is missing"},
      {"ply\nformat ascii 1.0\nelement a 1 2\n", 3, "'2' is one word too many"},
      {"ply\nformat ascii 1.0\nelement a 1\nelement a 1\n", 4, "element 'a' appears twice"},
      {"ply\nformat ascii 1.0\nproperty float x\n", 3, "'property' before any 'element'"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty half x\n", 4, "'half' is not a type of PLY"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty float\n", 4, "name of the property is missing"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty int x\nproperty int x\n", 5, "'x' appears twice"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty list float int x\n", 4, "floating-point type"},
      {"ply\nformat ascii 1.0\nelements a 1\n", 3, "'elements' is not a statement of a PLY header"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nelement face 1\n"
       "property list uchar int vertex_indices\nend_header\n0 0\n3 0 0 0\n",
       3, "no scalar property 'z'"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int corners\nend_header\n0 0 0\n3 0 0 0\n",
       7, "no list 'vertex_indices' of an integer type"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar float vertex_indices\nend_header\n0 0 0\n3 0 0 0\n",
       7, "no list 'vertex_indices' of an integer type"},
  };
  for (const Case& c : cases) {
    const std::string message = error(c.text);
    EXPECT_THAT(message, HasSubstr(fmt::format("mesh.ply:{}: ", c.line))) << c.text;
    EXPECT_THAT(message, HasSubstr(c.message)) << c.text;
  }
}

TEST_F(PlyReader, NamesLineAndFaultOfMalformedAsciiBodies) {
  struct Case {
    const char* body;  // From line 10, for 3 vertices and 1 face.
    std::size_t line;
    const char* message;
  };
  const std::vector<Case> cases{
      {"0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 11, "the line ends before the values"},
      {"0 0 0\n1 0 0 0\n0 1 0\n3 0 1 2\n", 11, "'0' is more than the header promises"},
      {"0 0 0\n1 0 abc\n0 1 0\n3 0 1 2\n", 11, "'abc' is not a number"},
      {"0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", 11, "'nan' is not a finite number"},
      {"0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n", 11, "'-inf' is not a finite number"},
      {"0 0 0\n1 0 2e18\n0 1 0\n3 0 1 2\n", 11, "'z' is 2e+18"},
      {"0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 13, "vertex index 3 is out of range; the file has 3 vertices"},
      {"0 0 0\n1 0 0\n\n0 1 0\n3 0 1 -1\n", 14, "vertex index -1 is out of range"},
      {"0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", 13, "1.5 stands where the header promises a whole number"},
      {"0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", 13, "list 'vertex_indices' has the length -3"},
      {"0 0 0\n1 0 0\n0 1 0\n1e30 0 1 2\n", 13, "list 'vertex_indices' has the length 1e+30"},
      {"0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n", 13, "the line ends before the values"},
      {"0 0 0\n1 0 0\n0 1 0\n2 0 1\n", 13, "a face with 2 corners; it needs at least 3"},
      {"0 0 0\n1 0 0\n0 1 0\n0\n", 13, "a face with 0 corners"},
      {"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n7 7\n", 15, "'7' follows the last element"},
      {"0 0 0\n1 0 0\n0 1 0\n", 7, "promises 1 of element 'face', but the file ends after 0"},
      {"0 0 0\n1 0 0\n", 3, "promises 3 of element 'vertex', but the file ends after 2"},
      {"", 3, "promises 3 of element 'vertex', but the file ends after 0"},
  };
  for (const Case& c : cases) {
    const std::string message = error("ply\nformat ascii 1.0\n" + header(3, 1) + "end_header\n" + c.body);
    EXPECT_THAT(message, HasSubstr(fmt::format("mesh.ply:{}: ", c.line))) << c.body;
    EXPECT_THAT(message, HasSubstr(c.message)) << c.body;
  }
}

TEST_F(PlyReader, LyingCountsAreRefusedBeforeTheyAreBelieved) {
  for (const std::string& format : kFormats) {
    BodyWriter body = square(format);
    body.list("uchar", "int", {0, 1, 2}).end_row();
    const auto file = [&](std::string_view vertices, std::string_view faces) {
      return body.file(fmt::format("element vertex {}\n{}element face {}\n{}", vertices, kXyz, faces, kFace));
    };
    EXPECT_THAT(error(file("4000000000", "1")),
                HasSubstr("mesh.ply:3: the header promises 4000000000 of element 'vertex'"));
    EXPECT_THAT(error(file("9000000000000000000", "1")), HasSubstr("vertices; split the mesh"));
    EXPECT_THAT(error(file("4", "4000000000")),
                HasSubstr("mesh.ply:7: the header promises 4000000000 of element 'face'"));
    EXPECT_THAT(error(file("4", "9223372036854775807")), HasSubstr("but the file ends after"));
  }
  EXPECT_THAT(error(square("ascii").list("uchar", "int", {0, 1, 2}).file(header(5, 1))),
              HasSubstr("promises 1 of element 'face', but the file ends after 0"));
}

TEST_F(PlyReader, TruncationIsCountedAtEveryByte) {
  for (const std::string& format : {kFormats[1], kFormats[2]}) {
    const std::string whole = square_file(format);
    const std::size_t body = whole.find("end_header\n") + 11;
    for (std::size_t size = body; size < whole.size(); ++size) {
      EXPECT_THAT(error(whole.substr(0, size)), HasSubstr("the file ends after")) << size;
    }
    EXPECT_THAT(error(whole.substr(0, body + 30)),
                HasSubstr("promises 4 of element 'vertex', but the file ends after "
                          "at most 2"));
    EXPECT_THAT(error(whole.substr(0, whole.size() - 1)), HasSubstr("ends after 1 of 2 of element 'face'"));
  }
}

TEST_F(PlyReader, NamesTheFaultOfMalformedBinaryBodies) {
  for (const std::string& format : {kFormats[1], kFormats[2]}) {
    const auto with_face = [&](const std::vector<double>& corners) {
      return square(format).list("uchar", "int", corners).file(header(4, 1));
    };
    EXPECT_THAT(error(with_face({0, 1, 4})),
                HasSubstr("mesh.ply: face 1 of 1: vertex index 4 is out of range"));
    EXPECT_THAT(error(with_face({0, 1, -1})), HasSubstr("vertex index -1 is out of range"));
    EXPECT_THAT(error(with_face({0, 1})), HasSubstr("a face with 2 corners"));
    EXPECT_THAT(error(with_face({0, 1, 2}) + "\n"), HasSubstr("1 bytes follow the last element"));

    BodyWriter negative = square(format);
    negative.put("char", -3).put("int", 0).put("int", 1).put("int", 2);
    EXPECT_THAT(error(negative.file(fmt::format(
                    "element vertex 4\n{}element face 1\nproperty list char int vertex_indices\n", kXyz))),
                HasSubstr("list 'vertex_indices' has the length -3"));
    BodyWriter huge = square(format);
    huge.put("uint", 4e9).put("int", 0).put("int", 1).put("int", 2);
    EXPECT_THAT(error(huge.file(fmt::format(
                    "element vertex 4\n{}element face 1\nproperty list uint int vertex_indices\n", kXyz))),
                HasSubstr("ends after 0 of 1 of element 'face'"));

    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 2e18}) {
      BodyWriter body(format);
      for (int i = 0; i < 3; ++i) body.put("float", 0).put("float", i == 1 ? bad : 0).put("float", 0);
      body.list("uchar", "int", {0, 1, 2});
      EXPECT_THAT(error(body.file(header(3, 1))), HasSubstr("mesh.ply: vertex 2 of 3: 'y' is "));
    }
  }
}

TEST_F(PlyReader, RefusesFilesWithoutASurface) {
  EXPECT_THAT(error(square("ascii").file(std::string("element vertex 4\n") + kXyz)),
              HasSubstr("point cloud"));
  EXPECT_THAT(error(square("binary_little_endian").file(header(4, 0))), HasSubstr("point cloud"));
  EXPECT_THAT(error(square("ascii").file(std::string("element vertex 4\n") + kXyz +
                                         "element range_grid 9\nproperty list uchar int vertex_indices\n")),
              HasSubstr("range grid"));
  EXPECT_THAT(error(BodyWriter("ascii").file(std::string("element face 0\n") + kFace)),
              HasSubstr("no element 'vertex'"));
  EXPECT_THAT(error(""), HasSubstr("the file is empty"));
  EXPECT_THAT(input_error_of([&] { static_cast<void>(read_ply(folder_ / "none.ply")); }),
              HasSubstr("the file does not exist"));
  EXPECT_THAT(input_error_of([&] { static_cast<void>(read_ply(folder_.path())); }),
              HasSubstr("this is a folder"));
}

TEST_F(PlyReader, SurvivesDamagedFiles) {
  const int rounds = 3000;
  std::uint64_t seed = 13;
  for (const std::string& format : kFormats) {
    BodyWriter body(format);
    for (int i = 0; i < 5; ++i) {
      body.put("float", i).put("float", i * i).put("float", 0.5);
      body.put("float", 0)
          .put("float", i % 2)
          .put("float", 0)
          .put("uchar", i)
          .put("float", 0)
          .put("float", i);
      body.end_row();
    }
    body.list("uchar", "int", {0, 1, 2}).list("uchar", "float", {1, 2}).end_row();
    body.list("uchar", "int", {1, 2, 3, 4}).list("uchar", "float", {}).end_row();
    body.list("int", "int", {0, 1, 2, 3, -1, 4, 3, 2}).end_row();
    const std::string text = body.file(
        fmt::format("comment c\nelement vertex 5\n{}property float nx\nproperty float ny\nproperty float "
                    "nz\nproperty uchar q\n"
                    "property float u\nproperty float v\nelement face 2\n{}property list uchar float w\n"
                    "element tristrips 1\nproperty list int int vertex_indices\n",
                    kXyz, kFace));
    const int accepted = test::count_accepted_mutations(text, rounds, seed++,
                                                        [](const auto& path) { read_ply(path).validate(); });
    EXPECT_GT(accepted, rounds / 50) << format;
    EXPECT_LT(accepted, rounds * 9 / 10) << format;
  }
}

}  // namespace
}  // namespace vrc
