// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/record_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <sstream>
#include <vector>

#include "core/error.h"
#include "support.h"

namespace vrc {
namespace {

/// A slow reader of the two kinds of PLY written here: elements of named scalars, then triangles.
struct SimplePly {
  std::size_t vertex_count = 0, face_count = 0;
  std::vector<std::map<std::string, double>> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

template <typename T>
T take(const std::string& bytes, std::size_t& at) {
  T value;
  if (at + sizeof(T) > bytes.size()) throw std::runtime_error("PLY is too short");
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  at += sizeof(T);
  return value;
}

SimplePly read_simple_ply(const std::filesystem::path& path) {
  const std::string bytes = test::read_file(path);
  const std::size_t end = bytes.find("end_header\n");
  if (end == std::string::npos) throw std::runtime_error("no header");
  std::istringstream header(bytes.substr(0, end));
  SimplePly ply;
  std::vector<std::pair<std::string, std::string>> properties;
  for (std::string line; std::getline(header, line);) {
    std::istringstream words(line);
    std::string keyword, type, name;
    words >> keyword >> type >> name;
    if (keyword == "element") (type == "vertex" ? ply.vertex_count : ply.face_count) = std::stoul(name);
    if (keyword == "property" && type != "list") properties.emplace_back(type, name);
  }
  std::size_t at = end + std::strlen("end_header\n");
  for (std::size_t v = 0; v < ply.vertex_count; ++v) {
    auto& vertex = ply.vertices.emplace_back();
    for (const auto& [type, name] : properties) {
      if (type == "float") vertex[name] = static_cast<double>(take<float>(bytes, at));
      if (type == "uchar") vertex[name] = take<std::uint8_t>(bytes, at);
      if (type == "uint") vertex[name] = take<std::uint32_t>(bytes, at);
    }
  }
  for (std::size_t f = 0; f < ply.face_count; ++f) {
    EXPECT_EQ(take<std::uint8_t>(bytes, at), 3);
    auto& face = ply.faces.emplace_back();
    for (auto& index : face) index = take<std::uint32_t>(bytes, at);
  }
  EXPECT_EQ(at, bytes.size());
  return ply;
}

std::vector<RecordMapEntry> two_records() {
  RecordMapEntry a;
  a.position = {1, 2, 3};
  a.normal = {0, 0, 1};
  a.axis1 = {0.6f, 0.8f, 0};
  a.axis2 = {-0.8f, 0.6f, 0};
  a.radius1 = 0.5f;
  a.radius2 = 0.125f;
  a.radiance = {0.1f, 0.2f, 0.3f};
  a.gradient = {4, 5};
  a.hessian = {3, 0, -7};
  a.region = 4;
  a.face = 123456;
  RecordMapEntry b = a;
  b.position = {-1, 0, 0};
  b.axis2 = -a.axis2;  // Left-handed axes.
  b.radius1 = 4.0f;
  b.radius2 = 1.0f;
  b.hessian = {1, 2, 1};
  return {a, b};
}

TEST(RecordMap, HoldsEveryFieldUnderItsName) {
  const test::TempDir folder;
  auto records = two_records();
  records[1].is_sh = 1;
  write_record_map(folder / "map.ply", records);
  const SimplePly ply = read_simple_ply(folder / "map.ply");
  ASSERT_EQ(ply.vertices.size(), 2u);
  const auto& v = ply.vertices[0];
  const std::map<std::string, double> expected{
      {"x", 1},      {"y", 2},         {"z", 3},         {"nx", 0},    {"ny", 0},    {"nz", 1},
      {"r1", 0.5},   {"r2", 0.125},    {"radius", 0.25}, {"e1x", 0.6}, {"e1y", 0.8}, {"e1z", 0},
      {"e2x", -0.8}, {"e2y", 0.6},     {"e2z", 0},       {"L_r", 0.1}, {"L_g", 0.2}, {"L_b", 0.3},
      {"g1", 4},     {"g2", 5},        {"h11", 3},       {"h12", 0},   {"h22", -7},  {"is_sh", 0},
      {"region", 4}, {"face", 123456}, {"quality", 7}};
  for (const auto& [name, value] : expected) {
    ASSERT_TRUE(v.contains(name)) << name;
    EXPECT_NEAR(v.at(name), value, 1e-6) << name;
  }
  EXPECT_EQ(v.size(), expected.size() + 3);               // and the colour
  EXPECT_NEAR(ply.vertices[1].at("quality"), 3.0, 1e-5);  // of the matrix 1 2 / 2 1
  EXPECT_EQ(ply.vertices[1].at("is_sh"), 1);
}

TEST(RecordMap, ColoursGrowLighterWithTheRadius) {
  const test::TempDir folder;
  write_record_map(folder / "map.ply", two_records());
  const SimplePly ply = read_simple_ply(folder / "map.ply");
  EXPECT_LT(ply.vertices[0].at("green") + 100, ply.vertices[1].at("green"));
}

TEST(RecordMap, OfNoRecordsIsAnEmptyPly) {
  const test::TempDir folder;
  write_record_map(folder / "map.ply", {});
  write_record_ellipses(folder / "ellipses.ply", {});
  EXPECT_EQ(read_simple_ply(folder / "map.ply").vertex_count, 0u);
  EXPECT_EQ(read_simple_ply(folder / "ellipses.ply").face_count, 0u);
}

TEST(RecordEllipses, LieOnTheEllipseAndFaceTheNormal) {
  const test::TempDir folder;
  const auto records = two_records();
  constexpr int kSegments = 24;
  write_record_ellipses(folder / "ellipses.ply", records, kSegments);
  const SimplePly ply = read_simple_ply(folder / "ellipses.ply");
  ASSERT_EQ(ply.vertices.size(), records.size() * (kSegments + 1));
  ASSERT_EQ(ply.faces.size(), records.size() * kSegments);
  const auto position = [&](std::uint32_t i) {
    return Vec3f(static_cast<float>(ply.vertices[i].at("x")), static_cast<float>(ply.vertices[i].at("y")),
                 static_cast<float>(ply.vertices[i].at("z")));
  };
  double area = 0.0;
  for (std::size_t f = 0; f < ply.faces.size(); ++f) {
    const RecordMapEntry& record = records[f / kSegments];
    const auto& [a, b, c] = ply.faces[f];
    EXPECT_EQ(position(a), record.position);
    for (const std::uint32_t corner : {b, c}) {
      const Vec3f d = position(corner) - record.position;
      EXPECT_NEAR(std::hypot(d.dot(record.axis1) / record.radius1, d.dot(record.axis2) / record.radius2), 1.0,
                  1e-5);
    }
    const Vec3f cross = (position(b) - position(a)).cross(position(c) - position(a));
    EXPECT_GT(cross.dot(record.normal), 0.0f);
    area += 0.5 * static_cast<double>(cross.norm());
  }
  const double inscribed = 0.5 * kSegments * std::sin(2 * kPi / kSegments);
  EXPECT_NEAR(area, inscribed * (0.5 * 0.125 + 4.0), 1e-4);
}

TEST(RecordEllipses, RejectsFewerThanThreeSegmentsAndBadPaths) {
  const test::TempDir folder;
  EXPECT_THROW(write_record_ellipses(folder / "e.ply", two_records(), 2), std::logic_error);
  EXPECT_THROW(write_record_map(folder / "no" / "m.ply", two_records()), InputError);
}

}  // namespace
}  // namespace vrc
