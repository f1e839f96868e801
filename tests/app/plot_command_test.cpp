// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <pugixml.hpp>

#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

using test::run_vrc;
using testing::HasSubstr;

class PlotCommand : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) {
    test::write_file(folder_ / name, content);
    return at(name);
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }

  test::TempDir folder_;
};

constexpr const char* kBench = R"({"scenes": [
  {"scene": "/a/half<box>.xml", "rows": [
    {"cache": {"cpu_seconds": 10.0, "relmse": 1e-4}, "path": {"cpu_seconds": 10.0, "relmse": 0.1}},
    {"cache": {"cpu_seconds": 1.0, "relmse": 1e-2}, "path": {"cpu_seconds": 1.0, "relmse": 1.0}}]},
  {"scene": "other.xml", "rows": [{"cache": {"cpu_seconds": 2.0, "relmse": 1e-3}}]}]})";

TEST_F(PlotCommand, DrawsAPanelForEachSceneOnLogarithmicAxes) {
  const auto result = run_vrc({"plot", file("bench.json", kBench), "-o", at("a.svg")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  pugi::xml_document svg;
  ASSERT_TRUE(svg.load_file(at("a.svg").c_str()));
  const std::string text = test::read_file(at("a.svg"));
  EXPECT_THAT(text,
              testing::AllOf(HasSubstr("half&lt;box&gt;"), HasSubstr(">other<"), HasSubstr("radiance cache"),
                             HasSubstr("path tracing"), HasSubstr("CPU seconds"), HasSubstr("relMSE")));
  // Two decades down along one decade to the right: the corners of the axes.
  const std::string first = svg.child("svg").child("polyline").attribute("points").value();
  EXPECT_EQ(first, "64.0,154.0 364.0,274.0 ");
  const auto lines = svg.child("svg").children("polyline");
  ASSERT_EQ(std::distance(lines.begin(), lines.end()), 3);
  // The cache of both scenes, and between them path tracing, which differs also without colours.
  std::vector<std::string> dashes;
  for (const pugi::xml_node& line : lines) dashes.emplace_back(line.attribute("stroke-dasharray").value());
  EXPECT_EQ(dashes[0], dashes[2]);
  EXPECT_NE(dashes[0], dashes[1]);
}

TEST_F(PlotCommand, ManyDecadesGetFewLabels) {
  const std::string bench = R"({"scenes": [{"scene": "a.xml", "rows": [
    {"cache": {"cpu_seconds": 1e-9, "relmse": 1e-2}, "path": {"cpu_seconds": 1e9, "relmse": 1.0}}]}]})";
  const auto result = run_vrc({"plot", file("bench.json", bench), "-o", at("a.svg")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  pugi::xml_document svg;
  ASSERT_TRUE(svg.load_file(at("a.svg").c_str()));
  std::size_t labels = 0;
  for (const pugi::xml_node& text : svg.child("svg").children("text")) labels += text.child("tspan") ? 1 : 0;
  EXPECT_EQ(labels, 10u + 3u);  // every second of 19 powers of ten, and 3
}

/// The texts of the plot in their order.
std::vector<std::string> texts_of(const std::string& file) {
  pugi::xml_document svg;
  EXPECT_TRUE(svg.load_file(file.c_str()));
  std::vector<std::string> texts;
  for (const pugi::xml_node& text : svg.child("svg").children("text")) {
    std::string whole = text.text().get();
    if (const pugi::xml_node power = text.child("tspan")) whole += std::string("^") + power.text().get();
    texts.push_back(whole);
  }
  return texts;
}

TEST_F(PlotCommand, FewDecadesAreDividedByOneTwoAndFive) {
  const std::string bench = R"({"scenes": [{"scene": "a.xml", "rows": [
    {"cache": {"cpu_seconds": 0.3, "relmse": 3e-4}}, {"cache": {"cpu_seconds": 3, "relmse": 3e-5}}]}]})";
  const auto result = run_vrc({"plot", file("bench.json", bench), "-o", at("a.svg")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(texts_of(at("a.svg")),
              testing::ElementsAre("a", "0.2", "0.5", "1", "2", "5", "2\u00b710^\u22125", "5\u00b710^\u22125",
                                   "10^\u22124", "2\u00b710^\u22124", "5\u00b710^\u22124", "CPU seconds",
                                   "relMSE", "radiance cache"));
}

TEST_F(PlotCommand, OnePointHasAxes) {
  const std::string bench =
      R"({"scenes": [{"scene": "a.xml", "rows": [{"cache": {"cpu_seconds": 2, "relmse": 0.03}}]}]})";
  const auto result = run_vrc({"plot", file("bench.json", bench), "-o", at("a.svg")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(texts_of(at("a.svg")),
              testing::ElementsAre("a", "2", "5", "0.02", "0.05", "CPU seconds", "relMSE", "radiance cache"));
}

TEST_F(PlotCommand, SaysWhatIsWrongWithItsInput) {
  const struct {
    std::string input;
    const char* message;
  } cases[] = {
      {at("missing.json"), "cannot be opened"},
      {file("a.json", "{"), "is no JSON"},
      {file("b.json", "{}"), "scenes"},
      {file("c.json", R"({"scenes": [{"scene": "a", "rows": [{"cache": {"relmse": 1}}]}]})"), "cpu_seconds"},
      {file("d.json", R"({"scenes": []})"), "no measurements"}};
  for (const auto& c : cases) {
    const auto result = run_vrc({"plot", c.input, "-o", at("a.svg")});
    EXPECT_EQ(result.exit_code, 2) << c.input;
    EXPECT_THAT(result.err, testing::AllOf(HasSubstr(c.input), HasSubstr(c.message)));
  }
  const auto wrong = run_vrc({"plot", file("e.json", kBench), "-o", at("a.png")});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr(".svg"));
}

}  // namespace
}  // namespace vrc
