// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/record_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <sstream>
#include <vector>

#include "core/error.h"
#include "exported_ply.h"
#include "support.h"

namespace vrc {
namespace {

using testing::ElementsAre;

std::vector<RecordMapEntry> two_records() {
  RecordMapEntry a;
  a.position = {1, 2, 3};
  a.normal = {0, 0, 1};
  a.axis1 = {0.6f, 0.8f, 0};
  a.axis2 = {-0.8f, 0.6f, 0};
  a.radius1 = 0.5f;
  a.radius2 = 0.125f;
  a.radiance = {0.1f, 0.2f, 0.3f};
  a.luminance_deviation = 0.01f;
  a.gradient = {4, 5};
  a.hessian = {3, 0, -7};
  a.clamp_factor = 0.75f;
  a.nearest_hit = 0.5f;
  a.mean_hit = 2.5f;
  a.curvature = {0.25, 2.0, 5.0, 40.0, CurvatureReason::kEllipseTurns};
  a.region = 4;
  a.face = 123456;
  a.patch = 9;
  a.uv = {-1.5f, 0.1f};
  a.rays = 8192;
  a.film = {12.5f, 40.25f};
  a.film_axis1 = {3, -4};
  a.film_axis2 = {0.5f, 0.25f};
  RecordMapEntry b = a;
  b.position = {-1, 0, 0};
  b.radius1 = 4.0f;
  b.radius2 = 1.0f;
  b.hessian = {1, 2, 1};
  b.curvature = {};
  b.nearest_hit = std::numeric_limits<float>::infinity();
  b.patch = kInvalidIndex;
  return {a, b};
}

const std::map<std::string, double>& first_record() {
  static const std::map<std::string, double> values{{"x", 1},
                                                    {"y", 2},
                                                    {"z", 3},
                                                    {"nx", 0},
                                                    {"ny", 0},
                                                    {"nz", 1},
                                                    {"r1", 0.5},
                                                    {"r2", 0.125},
                                                    {"radius", 0.25},
                                                    {"e1x", 0.6},
                                                    {"e1y", 0.8},
                                                    {"e1z", 0},
                                                    {"e2x", -0.8},
                                                    {"e2y", 0.6},
                                                    {"e2z", 0},
                                                    {"L_r", 0.1},
                                                    {"L_g", 0.2},
                                                    {"L_b", 0.3},
                                                    {"L_stddev", 0.01},
                                                    {"g1", 4},
                                                    {"g2", 5},
                                                    {"h11", 3},
                                                    {"h12", 0},
                                                    {"h22", -7},
                                                    {"quality", 7},
                                                    {"is_sh", 0},
                                                    {"sh_reason", 0},
                                                    {"needs_sh", 1},
                                                    {"deviation", 0.25},
                                                    {"curvature", 2},
                                                    {"relative_curvature", 5},
                                                    {"exponent", 40},
                                                    {"reason", 2},
                                                    {"clamp_factor", 0.75},
                                                    {"nearest_hit", 0.5},
                                                    {"mean_hit", 2.5},
                                                    {"region", 4},
                                                    {"face", 123456},
                                                    {"patch", 9},
                                                    {"u", -1.5},
                                                    {"v", 0.1},
                                                    {"rays", 8192},
                                                    {"px", 12.5},
                                                    {"py", 40.25},
                                                    {"p1x", 3},
                                                    {"p1y", -4},
                                                    {"p2x", 0.5},
                                                    {"p2y", 0.25}};
  return values;
}

TEST(RecordMap, HoldsEveryFieldUnderItsName) {
  const test::TempDir folder;
  auto records = two_records();
  records[1].harmonics_reason = HarmonicsReason::kTurns;
  write_surface(folder / "map.ply", record_map(records));
  const test::ExportedPly ply = test::read_exported_ply(folder / "map.ply");
  ASSERT_EQ(ply.vertices.size(), 2u);
  for (const auto& [name, value] : first_record()) {
    ASSERT_TRUE(ply.vertices[0].contains(name)) << name;
    EXPECT_NEAR(ply.vertices[0].at(name), value, 1e-6) << name;
  }
  EXPECT_EQ(ply.vertices[0].size(), first_record().size() + 3);  // and the colour
  EXPECT_NEAR(ply.vertices[1].at("quality"), 3.0, 1e-5);         // of the matrix 1 2 / 2 1
  EXPECT_EQ(ply.vertices[1].at("is_sh"), 1);
  EXPECT_EQ(ply.vertices[1].at("sh_reason"), 2);
  EXPECT_EQ(ply.vertices[1].at("needs_sh"), 0);
  EXPECT_EQ(ply.vertices[1].at("patch"), -1);
}

std::vector<std::string> cells(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> result;
  for (std::string cell; std::getline(in, cell, ',');) result.push_back(cell);
  return result;
}

TEST(RecordMap, AsCsvGivesBackEveryValueAndNamesReasons) {
  const test::TempDir folder;
  write_surface(folder / "map.CSV", record_map(two_records()));
  std::istringstream text(test::read_file(folder / "map.CSV"));
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(cells(line));
  ASSERT_EQ(lines.size(), 3u);
  std::map<std::string, std::string> first, second;
  for (std::size_t i = 0; i < lines[0].size(); ++i) {
    ASSERT_TRUE(first.emplace(lines[0][i], lines[1].at(i)).second) << lines[0][i];
    second[lines[0][i]] = lines[2].at(i);
  }
  for (const auto& [name, value] : first_record()) {
    ASSERT_TRUE(first.contains(name)) << name;
    if (name == "reason" || name == "sh_reason") continue;
    EXPECT_EQ(std::stof(first.at(name)), static_cast<float>(value)) << name;
  }
  EXPECT_EQ(first.at("L_r"), "0.1");  // the shortest text of the float
  EXPECT_EQ(first.at("reason"), "ellipse-turns");
  EXPECT_EQ(second.at("reason"), "flat");
  EXPECT_EQ(first.at("sh_reason"), "none");
  EXPECT_EQ(second.at("nearest_hit"), "inf");
}

TEST(RecordMap, ColoursGrowLighterWithTheRadiusAndShIsOrange) {
  const test::TempDir folder;
  auto records = two_records();
  records.push_back(records[0]);
  records[2].harmonics_reason = HarmonicsReason::kAlways;
  write_surface(folder / "map.ply", record_map(records));
  const test::ExportedPly ply = test::read_exported_ply(folder / "map.ply");
  EXPECT_LT(ply.vertices[0].at("green") + 100, ply.vertices[1].at("green"));
  EXPECT_EQ(ply.vertices[2].at("red"), 230.0);
}

TEST(RecordMap, OfNoRecordsIsAnEmptyFile) {
  const test::TempDir folder;
  for (const char* name : {"map.ply", "map.vtp", "map.csv"}) write_surface(folder / name, record_map({}));
  write_surface(folder / "ellipses.ply", record_ellipses({}, {}));
  EXPECT_TRUE(test::read_exported_ply(folder / "map.ply").vertices.empty());
  EXPECT_TRUE(test::read_exported_ply(folder / "ellipses.ply").triangles.empty());
}

TEST(RecordEllipses, NameTheirRecordsAndMarkTheirClass) {
  const test::TempDir folder;
  EllipseTessellation triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.normals.assign(3, Vec3::UnitZ());
  triangle.triangles = {{0, 1, 2}};
  const std::vector<EllipseTessellation> ellipses{triangle, triangle};
  auto records = two_records();
  records[0].harmonics_reason = HarmonicsReason::kReplacesMany;
  write_surface(folder / "e.ply", record_ellipses(records, ellipses));
  const test::ExportedPly ply = test::read_exported_ply(folder / "e.ply");
  ASSERT_EQ(ply.vertices.size(), 6u);
  EXPECT_THAT(ply.triangles, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(3, 4, 5)));
  EXPECT_EQ(ply.vertices[1].at("x"), 1.0);
  EXPECT_EQ(ply.vertices[2].at("nz"), 1.0);
  EXPECT_EQ(ply.vertices[2].at("record"), 0.0);
  EXPECT_EQ(ply.vertices[2].at("is_sh"), 1.0);
  EXPECT_EQ(ply.vertices[2].at("red"), 230.0);  // orange
  EXPECT_EQ(ply.vertices[5].at("record"), 1.0);
  EXPECT_EQ(ply.vertices[5].at("is_sh"), 0.0);
  EXPECT_NEAR(ply.vertices[5].at("quality"), 2.0, 1e-6);
}

TEST(RecordEllipses, RejectMissingEllipsesAndBadPaths) {
  const test::TempDir folder;
  EXPECT_THROW(static_cast<void>(record_ellipses(two_records(), {})), std::logic_error);
  EXPECT_THROW(write_surface(folder / "no" / "m.ply", record_map(two_records())), InputError);
  EXPECT_THROW(write_surface(folder / "m.xyz", record_map(two_records())), std::logic_error);
}

}  // namespace
}  // namespace vrc
