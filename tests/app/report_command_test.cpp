// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>

#include "browser.h"
#include "core/image_error.h"
#include "io/color.h"
#include "io/image_io.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_vrc;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

json tiny_table() {
  return json::parse(R"({
    "format": "vrc figure 1", "figure": 7, "title": "Tiny <figure>", "size": "quick", "unknown": [1, {"a": 2}],
    "claim": "It says </script><script>alert(1)</script> & more.",
    "groups": [{"name": "box", "panels": [
      {"id": "cache", "name": "Cache", "image": "cache.exr", "reference": "path", "records": "cache.csv",
       "command": "vrc render 'a & b'", "ours": {"records": 13100, "relmse": 0.00012}, "paper": {"records": 5000}},
      {"id": "path", "name": "Path </script>", "image": "path.exr", "ours": {"seconds": 1e-30, "cpu_seconds": 1e300}}
    ]}],
    "measures": [{"name": "rank < 1", "value": 0.5, "bound": ">= 0.7", "holds": false, "paper": null},
                 {"name": "second", "value": 12345678, "bound": "> 0", "holds": true}, {"name": "free", "value": -0.25}],
    "curves": [{"title": "box & co", "x": "CPU seconds", "y": "relMSE",
                "series": [{"name": "cache", "points": [[1.0, 0.01], [2.0, 0.003]]}]},
               {"title": "linear", "x": "angle", "y": "error", "series": [{"name": "a", "points": [[-1, 0], [1, 3]]}]},
               {"title": "Glossy Cornell box, 8192 rays a record", "x": "rays", "y": "relative RMS error", "series": [
                {"name": "Radiance caching of Krivanek, harmonics of order 10", "points": [[1024, 2e-5], [9000, 6e-4]]},
                {"name": "Path tracing", "points": [[1024, 1e-4]]}]}]
  })");
}

/// A figure of two pictures of 32 x 24 pixels, the second with a pixel of NaN, and the records of the first.
class ReportCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    rendered_ = new test::TempDir;
    const std::string scene = test::write_test_scene(rendered_->path()).string();
    const auto made =
        run_vrc({"render", scene, "--spp", "2", "--error", "0.3", "--gather-rays", "256", "--quiet", "-o",
                 (*rendered_ / "cache.exr").string(), "--record-map", (*rendered_ / "cache.csv").string()});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const auto path = run_vrc({"render", scene, "--spp", "2", "--method", "path", "--quiet", "-o",
                               (*rendered_ / "path.exr").string()});
    ASSERT_EQ(path.exit_code, 0) << path.err;
    Image picture = rgb("path.exr");
    picture.pixel(2, 3)[1] = std::numeric_limits<float>::quiet_NaN();
    picture.pixel(3, 3)[0] = std::numeric_limits<float>::infinity();
    picture.pixel(4, 3)[2] = 1e30f;
    picture.pixel(5, 3)[2] = -2.0f;
    write_exr(*rendered_ / "path.exr", picture);
  }
  static void TearDownTestSuite() { delete rendered_; }

  /// R, G, B of a picture that was rendered.
  static Image rgb(const std::string& name) {
    const Image whole = read_image(*rendered_ / name);
    return mean_rgb(whole, whole);
  }

  void SetUp() override { write_figure("figure_07", tiny_table()); }
  void write_figure(const std::string& name, const json& table) {
    fs::create_directories(folder_ / name);
    for (const char* file : {"cache.exr", "cache.csv", "path.exr"})
      fs::copy_file(*rendered_ / file, folder_ / name / file, fs::copy_options::overwrite_existing);
    test::write_file(folder_ / name / "table.json", table.dump());
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string page_of(const std::string& folder) const {
    const auto result = run_vrc({"report", at(folder), "-o", at("a.html")});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? test::read_file(at("a.html")) : "";
  }
  void expect_refused(const json& table, const std::vector<std::string>& messages) {
    test::write_file(folder_ / "figure_07" / "table.json", table.dump());
    const auto result = run_vrc({"report", at("figure_07"), "-o", at("a.html")});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& message : messages) EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(at("a.html")));
  }

  static test::TempDir* rendered_;
  test::TempDir folder_;
};

test::TempDir* ReportCommand::rendered_ = nullptr;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST_F(ReportCommand, HelpSaysWhatItTakes) {
  const auto help = run_vrc({"report", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("table.json"), HasSubstr("-o,--output"), HasSubstr("Examples:")));
  EXPECT_THAT(run_vrc({"--help"}).out, HasSubstr("vrc report"));
}

TEST_F(ReportCommand, MakesOnePageThatNeedsNothingElse) {
  const std::string page = page_of("figure_07");
  // The only address is the name of SVG.
  std::string rest = std::regex_replace(page, std::regex("xmlns=\"http://www.w3.org/2000/svg\""), "");
  EXPECT_THAT(rest, AllOf(Not(HasSubstr("http://")), Not(HasSubstr("https://")), Not(HasSubstr("src=")),
                          Not(HasSubstr("<link")), Not(HasSubstr("@import")), Not(HasSubstr("url("))));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  EXPECT_LT(page.size(), 200'000u);
}

TEST_F(ReportCommand, ShowsTextsTablesAndPlots) {
  const std::string page = page_of("figure_07");
  EXPECT_THAT(page, AllOf(HasSubstr("Tiny &lt;figure&gt;"), HasSubstr("Figure 7"), HasSubstr("quick")));
  EXPECT_THAT(page,
              AllOf(HasSubstr("13\u202f100</td><td class=\"paper\">5000</td>"),
                    HasSubstr("1.2\u202f\u00d7\u202f10\u207b\u2074"), HasSubstr("vrc render 'a &amp; b'")));
  EXPECT_THAT(page, AllOf(HasSubstr("\u2717 no"), HasSubstr("\u2713 yes"), HasSubstr("\u2265 0.7"),
                          HasSubstr("&gt; 0"), HasSubstr("12\u202f345\u202f678"), HasSubstr("\u22120.250"),
                          HasSubstr("1/2")));
  EXPECT_EQ(count(page, "<svg "), 3u);
  EXPECT_EQ(count(page, "<h3>Convergence</h3>"), 1u);
  EXPECT_THAT(page, AllOf(HasSubstr("box &amp; co"), HasSubstr(">linear</text>"), HasSubstr("-0.5")));
}

TEST_F(ReportCommand, TextOfTheTableStaysText) {
  const std::string page = page_of("figure_07");
  EXPECT_THAT(page, AllOf(Not(HasSubstr("<script>alert")), HasSubstr("&lt;script&gt;alert")));
  // Data, manifest and the script itself are the only scripts, and each ends once.
  const std::size_t scripts = count(page, "<script");
  EXPECT_EQ(scripts, 5u);  // manifest, two pictures, records, script
  EXPECT_EQ(count(page, "</script"), scripts);
  EXPECT_THAT(page, HasSubstr("Path \\u003c/script>"));
}

TEST_F(ReportCommand, TakesFoldersOfFiguresOnce) {
  json second = tiny_table();
  second["figure"] = 12;
  second["title"] = "Another";
  write_figure("figure_12", second);
  const auto result = run_vrc({"report", folder_.path().string(), at("figure_12"), "-o", at("a.html")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("2 figures"));
  const std::string page = test::read_file(at("a.html"));
  EXPECT_EQ(count(page, "<section class=\"figure\""), 2u);
  EXPECT_LT(page.find("Tiny"), page.find("Another"));
  EXPECT_EQ(count(page, "application/octet-stream"), 3u) << "equal pictures are kept once";
}

TEST_F(ReportCommand, ReadsAFigureWithoutPictures) {
  test::write_file(folder_ / "f" / "table.json",
                   R"({"format": "vrc figure 1", "figure": 1, "title": "Bare"})");
  EXPECT_THAT(page_of("f"), AllOf(HasSubstr("Bare"), Not(HasSubstr("class=\"viewer\" data"))));
}

TEST_F(ReportCommand, SaysWhatIsWrongWithATable) {
  const auto changed = [](const std::string& pointer, const json& value) {
    json table = tiny_table();
    table[json::json_pointer(pointer)] = value;
    return table;
  };
  json untitled = tiny_table();
  untitled.erase("title");
  expect_refused(untitled, {"table.json: title is missing"});
  expect_refused(changed("/format", "vrc figure 2"), {"format is 'vrc figure 2'", "reads 'vrc figure 1'"});
  expect_refused(changed("/figure", 1.5), {"figure must be a whole number"});
  expect_refused(changed("/groups/0/panels/1/name", 3), {"groups[0].panels[1].name must be text"});
  expect_refused(changed("/groups/0/panels/0/reference", "x"), {"groups[0].panels[0].reference", "'x'"});
  expect_refused(changed("/groups/0/panels/0/image", "../cache.exr"),
                 {"groups[0].panels[0].image", "in the folder"});
  expect_refused(changed("/groups/0/panels/0/image", "none.exr"),
                 {"none.exr: is missing", "groups[0].panels[0].image"});
  expect_refused(changed("/groups/0/panels/0/records", "none.csv"), {"none.csv: is missing"});
  expect_refused(changed("/groups/0/panels/0/records", "path.exr"), {"path.exr:1: has no column 'px'"});
  expect_refused(changed("/groups/0/panels", 1), {"groups[0].panels must be a list"});
  expect_refused(changed("/measures/0/holds", "yes"), {"measures[0].holds must be true or false"});
  expect_refused(changed("/curves/0/series/0/points/0", json::array({1})), {"curves[0].series[0].points[0]"});
  expect_refused(json::array(), {"the whole must be an object"});
}

TEST_F(ReportCommand, SaysWhatIsWrongWithItsFiles) {
  test::write_file(folder_ / "figure_07" / "table.json", "{\"format\": ");
  auto result = run_vrc({"report", at("figure_07"), "-o", at("a.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("table.json"), HasSubstr("is no JSON")));

  write_figure("figure_07", tiny_table());
  write_exr(folder_ / "figure_07" / "path.exr", Image(8, 8, {"R", "G", "B"}));
  result = run_vrc({"report", at("figure_07"), "-o", at("a.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("path.exr: has 8x8 pixels"), HasSubstr("32x24"), HasSubstr("one size")));

  write_figure("figure_07", tiny_table());
  test::write_file(folder_ / "figure_07" / "cache.csv",
                   "px,py,p1x,p1y,p2x,p2y\n1,2,3,4,5,6\n1,2,3,4,5,six\n");
  result = run_vrc({"report", at("figure_07"), "-o", at("a.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("cache.csv:3:"), HasSubstr("'six' of column 'p2y'")));

  fs::create_directories(folder_ / "empty");
  result = run_vrc({"report", at("empty"), "-o", at("a.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("holds no table.json"));
  result = run_vrc({"report", at("nowhere"), "-o", at("a.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("is no folder"));
  result = run_vrc({"report", at("figure_07"), "-o", at("a.pdf")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr(".html"));
}

// What the page must show in a browser, as the program computes it.

json rgb_of(const std::array<std::uint8_t, 3>& color) { return {color[0], color[1], color[2]}; }

/// As write_png has it.
json shown_pixel(const Image& picture, int x, int y, const Display& display) {
  const float* p = displayed(picture, display).pixel(x, y);
  if (std::isnan(p[0]) || std::isnan(p[1]) || std::isnan(p[2])) return {255, 0, 255};
  return {quantize8(srgb_from_linear(p[0])), quantize8(srgb_from_linear(p[1])),
          quantize8(srgb_from_linear(p[2]))};
}

/// As `vrc compare --heatmap` has it.
json error_pixel(const Image& errors, int x, int y) {
  const double e = errors.pixel(x, y)[0];
  if (!std::isfinite(e)) return {255, 0, 255};
  return rgb_of(map_color8((std::log10(e) + 3.0) / 3.0));
}

json expected_pixels(const Image& cache, const Image& path) {
  const Image errors = relative_error_map(cache, path);
  json pixels = json::array();
  for (const auto& [x, y] :
       std::vector<std::pair<int, int>>{{2, 3}, {3, 3}, {4, 3}, {5, 3}, {9, 14}, {16, 12}, {30, 20}}) {
    json pixel{{"x", x}, {"y", y}, {"error", error_pixel(errors, x, y)}};
    const struct {
      const char* name;
      Tonemap tonemap;
    } curves[] = {{"none", Tonemap::kNone}, {"reinhard", Tonemap::kReinhard}, {"aces", Tonemap::kAces}};
    for (const auto& curve : curves) {
      for (const double exposure : {0.0, -2.5}) {
        const Display display{exposure, curve.tonemap};
        pixel["shown"].push_back({{"tone", curve.name},
                                  {"exposure", exposure},
                                  {"cache", shown_pixel(cache, x, y, display)},
                                  {"path", shown_pixel(path, x, y, display)}});
      }
    }
    pixels.push_back(pixel);
  }
  return pixels;
}

class ReportInBrowser : public ReportCommand {
 protected:
  /// The page with tests/app/report_page_test.js at its end, which runs to its end: what it has written.
  std::string results(const fs::path& opened, int width, int height) const {
    const std::string dom = test::dump_dom(opened, folder_.path(), width, height);
    const std::string mark = "<pre id=\"results\">";
    const std::size_t begin = dom.find(mark);
    if (begin == std::string::npos) return "the script wrote nothing: " + dom.substr(0, 2000);
    return dom.substr(begin + mark.size(), dom.find("</pre>", begin) - begin - mark.size());
  }
  fs::path write_tested_page() const {
    std::string page = page_of("figure_07");
    const json expected{{"pixels", expected_pixels(rgb("cache.exr"), rgb("path.exr"))}};
    const std::string script = test::read_file(VRC_SOURCE_DIR "/tests/app/report_page_test.js");
    page.insert(page.find("<style>"),
                "<script>const errors = []; addEventListener('error', (e) => errors.push(e.message));"
                "addEventListener('unhandledrejection', (e) => errors.push(String(e.reason)));</script>");
    page.insert(page.rfind("</body>"),
                "<script>const expected = " + expected.dump() + ";\n" + script + "</script>\n");
    return test::write_file(folder_ / "tested.html", page);
  }
  /// Windows are never as narrow as telephones, frames are.
  [[nodiscard]] fs::path write_frame(int width) const {
    return test::write_file(
        folder_ / "frame.html",
        fmt::format(
            "<body style=\"margin:0\"><iframe src=\"tested.html\" width=\"{}\" height=\"780\" "
            "frameborder=\"0\"></iframe><pre id=\"results\"></pre><script>addEventListener('message', "
            "(e) => {{ document.getElementById('results').textContent = e.data; }});</script></body>",
            width));
  }
};

TEST_F(ReportInBrowser, FlipsZoomsSplitsAndShowsErrorsAndRecords) {
  if (!test::has_browser()) GTEST_SKIP() << "no Chromium on this machine";
  write_tested_page();
  const std::string text = results(folder_ / "tested.html", 1280, 900);
  EXPECT_THAT(text, AllOf(HasSubstr("ok finished"), Not(HasSubstr("FAILED")))) << text;
  EXPECT_GE(count(text, "ok "), 30u);
}

TEST_F(ReportInBrowser, WorksOnATelephone) {
  if (!test::has_browser()) GTEST_SKIP() << "no Chromium on this machine";
  write_tested_page();
  const std::string text = results(write_frame(360), 800, 800);
  EXPECT_THAT(text, AllOf(HasSubstr("ok finished"), Not(HasSubstr("FAILED")))) << text;
}

}  // namespace
}  // namespace vrc
