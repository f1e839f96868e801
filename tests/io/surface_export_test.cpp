// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/surface_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <pugixml.hpp>

#include "core/error.h"
#include "exported_ply.h"
#include "io/ply_reader.h"
#include "support.h"

namespace vrc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two triangles with arrays of each kind.
SurfaceExport quad() {
  SurfaceExport surface;
  surface.comment = "two triangles";
  surface.positions = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0.5f}};
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  surface.vertex_arrays = {
      {"Normals", {"nx", "ny", "nz"}, std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0}},
      {"color", {"red", "green", "blue"}, std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 255}},
      {"k1", {"k1"}, std::vector<float>{0.25f, -1, 2, 3}},
  };
  surface.face_arrays = {{"patch", {"patch"}, std::vector<std::int32_t>{7, -1}}};
  return surface;
}

/// RFC 4648, one character at a time.
std::string decode_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) continue;
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>((bits >> count) & 0xff);
  }
  return bytes;
}

template <typename T>
std::vector<T> values_of(const pugi::xml_node& parent, const char* name) {
  const pugi::xml_node node = parent.find_child_by_attribute("DataArray", "Name", name);
  const std::string bytes = decode_base64(node.child_value());
  std::uint64_t size = 0;
  if (bytes.size() < sizeof(size)) return {};
  std::memcpy(&size, bytes.data(), sizeof(size));
  EXPECT_EQ(size + sizeof(size), bytes.size()) << name;
  std::vector<T> values(size / sizeof(T));
  std::memcpy(values.data(), bytes.data() + sizeof(size), values.size() * sizeof(T));
  return values;
}

TEST(SurfaceExport, PlyHoldsTheArraysAsProperties) {
  const test::TempDir folder;
  write_surface_ply(folder / "quad.ply", quad());
  const test::ExportedPly ply = test::read_exported_ply(folder / "quad.ply");
  EXPECT_THAT(ply.vertex_properties,
              ElementsAre("float x", "float y", "float z", "float nx", "float ny", "float nz", "uchar red",
                          "uchar green", "uchar blue", "float k1"));
  EXPECT_THAT(ply.face_properties, ElementsAre("int patch"));
  ASSERT_EQ(ply.vertices.size(), 4u);
  EXPECT_EQ(ply.vertices[3].at("z"), 0.5);
  EXPECT_EQ(ply.vertices[3].at("nx"), 1.0);
  EXPECT_EQ(ply.vertices[3].at("blue"), 255.0);
  EXPECT_EQ(ply.vertices[0].at("k1"), 0.25);
  EXPECT_THAT(ply.triangles, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(0, 2, 3)));
  EXPECT_EQ(ply.faces[0].at("patch"), 7.0);
  EXPECT_EQ(ply.faces[1].at("patch"), -1.0);
}

TEST(SurfaceExport, PlyIsReadBack) {
  const test::TempDir folder;
  write_surface_ply(folder / "quad.ply", quad());
  const PolygonSoup soup = read_ply(folder / "quad.ply");
  EXPECT_EQ(soup.face_count(), 2u);
  EXPECT_EQ(soup.positions.size(), 4u);
  EXPECT_EQ(soup.normals.size(), 4u);
}

TEST(SurfaceExport, VtpIsXmlWithEveryArray) {
  const test::TempDir folder;
  write_surface_vtp(folder / "quad.vtp", quad());
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file((folder / "quad.vtp").c_str()));
  const pugi::xml_node file = document.child("VTKFile");
  EXPECT_STREQ(file.attribute("type").value(), "PolyData");
  EXPECT_STREQ(file.attribute("header_type").value(), "UInt64");
  const pugi::xml_node piece = file.child("PolyData").child("Piece");
  EXPECT_EQ(piece.attribute("NumberOfPoints").as_int(), 4);
  EXPECT_EQ(piece.attribute("NumberOfPolys").as_int(), 2);
  EXPECT_STREQ(piece.child("PointData").attribute("Normals").value(), "Normals");
  EXPECT_THAT(values_of<float>(piece.child("Points"), "Points"),
              ElementsAre(0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0.5f));
  EXPECT_THAT(values_of<float>(piece.child("PointData"), "k1"), ElementsAre(0.25f, -1, 2, 3));
  EXPECT_THAT(values_of<std::uint8_t>(piece.child("PointData"), "color"),
              ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 255));
  EXPECT_THAT(values_of<std::int32_t>(piece.child("CellData"), "patch"), ElementsAre(7, -1));
  EXPECT_THAT(values_of<std::int32_t>(piece.child("Polys"), "connectivity"), ElementsAre(0, 1, 2, 0, 2, 3));
  EXPECT_THAT(values_of<std::int32_t>(piece.child("Polys"), "offsets"), ElementsAre(3, 6));
}

TEST(SurfaceExport, PointsAreCellsOfAVtpAndAPlyWithoutFaces) {
  const test::TempDir folder;
  SurfaceExport points = quad();
  points.triangles.clear();
  points.face_arrays.clear();
  write_surface_ply(folder / "points.ply", points);
  EXPECT_EQ(test::read_exported_ply(folder / "points.ply").vertices.size(), 4u);
  EXPECT_THAT(test::read_file(folder / "points.ply"), testing::Not(HasSubstr("element face")));
  write_surface_vtp(folder / "points.vtp", points);
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file((folder / "points.vtp").c_str()));
  const pugi::xml_node piece = document.child("VTKFile").child("PolyData").child("Piece");
  EXPECT_EQ(piece.attribute("NumberOfVerts").as_int(), 4);
  EXPECT_EQ(piece.attribute("NumberOfPolys").as_int(), 0);
  EXPECT_THAT(values_of<std::int32_t>(piece.child("Verts"), "connectivity"), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(values_of<std::int32_t>(piece.child("Verts"), "offsets"), ElementsAre(1, 2, 3, 4));
  const pugi::xml_node normals =
      piece.child("PointData").find_child_by_attribute("DataArray", "Name", "Normals");
  EXPECT_EQ(normals.attribute("NumberOfComponents").as_int(), 3);
  EXPECT_EQ(values_of<float>(piece.child("PointData"), "k1").size(), 4u);
}

TEST(SurfaceExport, CsvHasALineForEachVertexAndWordsForNumbers) {
  const test::TempDir folder;
  SurfaceExport surface = quad();
  surface.vertex_arrays = {{"k1", {"k1"}, std::vector<float>{0.1f, -1, 1e-30f, 3}},
                           {"class", {"class"}, std::vector<std::uint8_t>{0, 1, 1, 9}, {"flat", "bent"}}};
  write_surface_csv(folder / "a.csv", surface);
  EXPECT_EQ(test::read_file(folder / "a.csv"),
            "x,y,z,k1,class\n0,0,0,0.1,flat\n1,0,0,-1,bent\n1,2,0,1e-30,bent\n0,2,0.5,3,9\n");
}

TEST(SurfaceExport, TakesAMeshWithoutFaces) {
  const test::TempDir folder;
  write_surface_ply(folder / "empty.ply", {});
  EXPECT_EQ(test::read_exported_ply(folder / "empty.ply").vertices.size(), 0u);
  write_surface_vtp(folder / "empty.vtp", {});
  pugi::xml_document document;
  EXPECT_TRUE(document.load_file((folder / "empty.vtp").c_str()));
}

TEST(SurfaceExport, ChecksItsArrays) {
  const test::TempDir folder;
  SurfaceExport surface = quad();
  surface.vertex_arrays[2].values = std::vector<float>(3);
  EXPECT_THROW(write_surface_ply(folder / "a.ply", surface), std::logic_error);
  surface = quad();
  surface.triangles[1][2] = 4;
  EXPECT_THROW(write_surface_vtp(folder / "a.vtp", surface), std::logic_error);
  surface = quad();
  surface.comment = "a -- b";
  EXPECT_THROW(write_surface_vtp(folder / "a.vtp", surface), std::logic_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SurfaceExport, NamesTheFileThatCannotBeWritten) {
  const test::TempDir folder;
  const auto path = folder / "missing" / "quad.vtp";
  try {
    write_surface_vtp(path, quad());
    FAIL() << "wrote " << path;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(path.string()));
  }
}

}  // namespace
}  // namespace vrc
