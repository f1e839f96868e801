// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "io/image_io.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_vrc;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

/// Runs small figures into a folder of its own.
class Figure : public testing::Test {
 protected:
  [[nodiscard]] test::ProgramResult make(const std::string& number,
                                         const std::vector<std::string>& extra = {}) const {
    std::vector<std::string> words = {"figure", number, "--quick", "--quiet", "-o", folder_.path().string()};
    words.insert(words.end(), extra.begin(), extra.end());
    return run_vrc(words);
  }
  [[nodiscard]] fs::path file(int number, const std::string& name) const {
    return folder_ / fmt::format("figure_{:02}", number) / name;
  }
  [[nodiscard]] json table(int number) const {
    return json::parse(test::read_file(file(number, "table.json")));
  }

  /// Makes the figure and checks what every table.json must hold; the numbers of the panels by their ids.
  std::map<std::string, json> make_whole(int number) {
    const auto result = make(std::to_string(number));
    EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
    const json made = table(number);
    EXPECT_EQ(made.at("format"), "vrc figure 1");
    EXPECT_EQ(made.at("figure"), number);
    EXPECT_EQ(made.at("size"), "quick");
    std::map<std::string, json> numbers;
    for (const json& group : made.at("groups")) {
      std::pair<int, int> size;
      for (const json& panel : group.at("panels")) {
        const Image image = read_image(file(number, panel.at("image")));
        if (size.first == 0) size = {image.width, image.height};
        EXPECT_EQ(size, std::pair(image.width, image.height)) << panel.at("id");
        for (const char* name : {"png", "records", "error", "overlay"}) {
          EXPECT_TRUE(!panel.contains(name) || fs::is_regular_file(file(number, panel.at(name)))) << name;
        }
        EXPECT_THAT(panel.at("command").get<std::string>(), testing::StartsWith("vrc "));
        numbers[panel.at("id")] = panel.at("ours");
        EXPECT_TRUE(!panel.contains("reference") || numbers.contains(panel.at("reference")));
      }
    }
    for (const json& curves : made.at("curves")) check_curves(number, curves);
    EXPECT_GT(made.at("measures").size(), 1u);
    for (const json& measure : made.at("measures")) {
      EXPECT_TRUE(measure.value("holds", true)) << measure;
    }
    return numbers;
  }

  /// Points are finite and positive, and the plot beside the table shows every series and point.
  void check_curves(int number, const json& curves) const {
    const std::string file_name = curves.at("svg");
    const std::string text = test::read_file(file(number, file_name));
    pugi::xml_document svg;
    ASSERT_TRUE(svg.load_string(text.c_str())) << file_name;
    EXPECT_THAT(text, AllOf(HasSubstr(curves.at("title").get<std::string>()),
                            HasSubstr(fmt::format(">{}<", curves.at("x").get<std::string>())),
                            HasSubstr(fmt::format(">{}<", curves.at("y").get<std::string>()))));
    auto line = svg.child("svg").child("polyline");
    for (const json& series : curves.at("series")) {
      EXPECT_GE(series.at("points").size(), 3u) << file_name << ": " << series.at("name");
      for (const json& point : series.at("points")) {
        for (const json& coordinate : point) {
          EXPECT_TRUE(std::isfinite(coordinate.get<double>()) && coordinate > 0.0) << file_name << point;
        }
      }
      EXPECT_EQ(words_in(line.attribute("points").value()), series.at("points").size()) << file_name;
      line = line.next_sibling("polyline");
    }
    EXPECT_FALSE(line) << file_name;
    std::vector<std::string> texts;
    for (const pugi::xml_node& node : svg.child("svg").children("text"))
      texts.emplace_back(node.text().get());
    for (const json& series : curves.at("series"))
      EXPECT_THAT(texts, Contains(series.at("name").get<std::string>())) << file_name;
  }

  static std::size_t words_in(const std::string& text) {
    std::istringstream stream(text);
    return static_cast<std::size_t>(
        std::distance(std::istream_iterator<std::string>(stream), std::istream_iterator<std::string>()));
  }

  /// The errors of a series of the curves in that file, in the order of its points.
  [[nodiscard]] std::vector<double> errors_along(int number, const std::string& svg,
                                                 const std::string& name) const {
    const json made = table(number);
    std::vector<double> errors;
    for (const json& curves : made.at("curves")) {
      if (curves.at("svg") != svg) continue;
      for (const json& series : curves.at("series")) {
        if (series.at("name") != name) continue;
        for (const json& point : series.at("points")) errors.push_back(point.at(1));
      }
    }
    EXPECT_GE(errors.size(), 3u) << svg << ": " << name;
    return errors;
  }

  /// Of the measure whose name begins like this.
  [[nodiscard]] double measured(int number, const std::string& name) const {
    const json made = table(number);
    for (const json& measure : made.at("measures")) {
      if (measure.at("name").get<std::string>().starts_with(name)) return measure.at("value");
    }
    ADD_FAILURE() << "no measure " << name;
    return 0.0;
  }

  test::TempDir folder_;
};

double relmse(const std::map<std::string, json>& panels, const std::string& id) {
  return panels.at(id).at("relmse");
}

/// Every error is below the one before.
MATCHER(Falls, "") { return std::ranges::adjacent_find(arg, std::less_equal<>()) == arg.end(); }

TEST_F(Figure, N1RecordsFollowTheHessian) {
  const auto panels = make_whole(1);
  const double records = panels.at("view_independent").at("records");
  EXPECT_NEAR(panels.at("view_dependent").at("records"), records, 0.1 * records);
  EXPECT_GT(measured(1, "density of view-dependent"), 0.5);
  EXPECT_GT(measured(1, "the same beyond"), 0.25);
  EXPECT_GT(relmse(panels, "view_independent"), 1.1 * relmse(panels, "view_dependent"));
}

TEST_F(Figure, N2HarmonicsRing) {
  const auto panels = make_whole(2);
  EXPECT_GT(relmse(panels, "harmonics"), 10.0 * relmse(panels, "analytic"));
  const auto radiance = errors_along(2, "curve_records.svg", "Radiance");
  EXPECT_GT(relmse(panels, "harmonics"), 3.0 * radiance.front());
  EXPECT_GT(radiance.front(), 1.5 * radiance.back());
}

TEST_F(Figure, N3GlossyGlossyTermInTheBox) {
  const auto panels = make_whole(3);
  EXPECT_GT(relmse(panels, "without"), 1.3 * relmse(panels, "with"));
  EXPECT_GT(relmse(panels, "standard"), 3.0 * relmse(panels, "with"));
  const std::string with = "With the glossy-glossy term";
  EXPECT_THAT(errors_along(3, "records_curve_records.svg", with), Falls());
  const auto by_rays = errors_along(3, "rays_curve_gather_rays.svg", with);
  EXPECT_GT(by_rays.front(), 2.0 * by_rays.back());
}

TEST_F(Figure, N4GlossyGlossyTermMattersOnlyBetweenGlossySurfaces) {
  const auto panels = make_whole(4);
  EXPECT_GT(relmse(panels, "glossy_without"), 10.0 * relmse(panels, "glossy_with"));
  EXPECT_LT(relmse(panels, "diffuse_without"), 1.5 * relmse(panels, "diffuse_with"));
  const auto with = errors_along(4, "glossy_curve_records.svg", "With the glossy-glossy term");
  EXPECT_THAT(with, Falls());
  EXPECT_THAT(errors_along(4, "glossy_curve_records.svg", "Without the glossy-glossy term"),
              testing::Pointwise(testing::Gt(), with));
}

TEST_F(Figure, N5DerivativesAgreeWithFiniteDifferences) {
  const auto panels = make_whole(5);
  const auto error = [&](const std::string& id) { return panels.at(id).at("relative_rms").get<double>(); };
  EXPECT_LT(error("glossy_pair_analytic_gradient"), 0.1);
  EXPECT_LT(error("glossy_pair_analytic_hessian"), 0.2);
  for (const std::string method : {"no-glossy-glossy", "sh"}) {
    for (const std::string quantity : {"_gradient", "_hessian"}) {
      EXPECT_GT(error("glossy_pair_" + method + quantity), 10.0 * error("glossy_pair_analytic" + quantity));
      EXPECT_GT(error("half_box_" + method + quantity), 1.5 * error("half_box_analytic" + quantity));
    }
  }
  // More rays help only derivatives that are right.
  for (const std::string svg :
       {"glossy_pair_gradient_gather_rays.svg", "glossy_pair_hessian_gather_rays.svg"}) {
    EXPECT_THAT(errors_along(5, svg, "Analytic"), Falls()) << svg;
    for (const char* name : {"Without the glossy-glossy term", "Spherical harmonics"}) {
      const auto errors = errors_along(5, svg, name);
      EXPECT_GT(errors.back(), 0.8 * errors.front()) << svg << ": " << name;
    }
  }
}

TEST_F(Figure, N6HigherOrdersHaveSmallerErrors) {
  const auto panels = make_whole(6);
  EXPECT_EQ(panels.at("glossy_pair_order_0").at("records"), panels.at("glossy_pair_order_2").at("records"));
  EXPECT_GT(relmse(panels, "glossy_pair_order_0"), 1.5 * relmse(panels, "glossy_pair_order_1"));
  EXPECT_GT(relmse(panels, "glossy_pair_order_1"), 1.5 * relmse(panels, "glossy_pair_order_2"));
  EXPECT_GT(relmse(panels, "half_box_order_0"), 1.5 * relmse(panels, "half_box_order_1"));
  std::vector<double> lower;
  for (const char* order : {"Order 0", "Order 1", "Order 2"}) {
    const auto errors = errors_along(6, "glossy_pair_curve_records.svg", order);
    EXPECT_THAT(errors, Falls()) << order;
    if (!lower.empty()) {
      EXPECT_THAT(errors, testing::Pointwise(testing::Lt(), lower)) << order;
    }
    lower = errors;
  }
}

TEST_F(Figure, N7RadianceIsBestAtEqualTime) {
  const auto panels = make_whole(7);
  EXPECT_GT(relmse(panels, "harmonics"), 2.0 * relmse(panels, "analytic"));
  EXPECT_GT(relmse(panels, "harmonics_single"), 2.0 * relmse(panels, "analytic_single"));
  EXPECT_GT(relmse(panels, "path"), 5.0 * relmse(panels, "analytic"));
  // CPU times scatter where machines are shared.
  for (const char* id : {"analytic_single", "harmonics", "harmonics_single", "path"}) {
    const double seconds = panels.at(id).at("cpu_seconds"), wanted = panels.at("analytic").at("cpu_seconds");
    EXPECT_GT(seconds, 0.6 * wanted) << id;
    EXPECT_LT(seconds, 1.6 * wanted) << id;
  }
  for (const char* over : {"cpu_seconds", "rays"}) {
    const std::string svg = fmt::format("curve_{}.svg", over);
    EXPECT_THAT(errors_along(7, svg, "Radiance, overture"), Falls()) << over;
    EXPECT_THAT(errors_along(7, svg, "Path tracing"), Falls()) << over;
  }
  EXPECT_GE(errors_along(7, "curve_records.svg", "Radiance, overture").size(), 3u);
}

TEST_F(Figure, N8OrderOfTheStrategies) {
  const auto panels = make_whole(8);
  EXPECT_GT(relmse(panels, "outgoing"), 1.1 * relmse(panels, "view_dependent"));
  EXPECT_GT(relmse(panels, "harmonics"), 1.5 * relmse(panels, "outgoing"));
  const auto view_dependent = errors_along(8, "curve_records.svg", "View-dependent, radiance");
  EXPECT_THAT(view_dependent, Falls());
  EXPECT_THAT(errors_along(8, "curve_records.svg", "View-independent, spherical harmonics"),
              testing::Pointwise(testing::Gt(), view_dependent));
}

TEST_F(Figure, N9GgxAgainstPathTracing) {
  const auto panels = make_whole(9);
  EXPECT_GT(relmse(panels, "box_path"), 5.0 * relmse(panels, "box_cache"));
  EXPECT_THAT(errors_along(9, "box_curve_rays.svg", "The paper's records"), Falls());
}

TEST_F(Figure, N10CloseUpsOfTheKitchen) {
  const auto panels = make_whole(10);
  for (const std::string view : {"pots", "worktop"}) {
    const double ours = panels.at(view + "_view_dependent").at("median_error");
    EXPECT_GT(panels.at(view + "_harmonics").at("median_error"), 1.1 * ours) << view;
  }
}

TEST_F(Figure, N11PotsFlatHybridAndOurs) {
  const auto panels = make_whole(11);
  EXPECT_GT(panels.at("flat").at("records"), 1.4 * panels.at("hybrid").at("records").get<double>());
  EXPECT_LT(relmse(panels, "hybrid"), 1.4 * relmse(panels, "flat"));
  EXPECT_GT(relmse(panels, "hybrid"), 1.2 * relmse(panels, "ours"));
  EXPECT_GT(relmse(panels, "flat"), 1.2 * relmse(panels, "ours"));
}

TEST_F(Figure, N12ReflectionOfTheCrown) {
  const auto panels = make_whole(12);
  EXPECT_GT(relmse(panels, "plate_path"), 1.2 * relmse(panels, "plate_cache"));
  EXPECT_GT(relmse(panels, "plate_path"), 2.0 * relmse(panels, "plate_ours"));
  EXPECT_THAT(errors_along(12, "plate_curve_rays.svg", "Path tracing"), Falls());
}

/// Lines of a panel that was found made.
std::ptrdiff_t count_kept(const std::string& text) {
  std::ptrdiff_t count = 0;
  for (std::size_t at = text.find("(kept)"); at != std::string::npos; at = text.find("(kept)", at + 1))
    ++count;
  return count;
}

TEST_F(Figure, KeepsWhatIsThere) {
  ASSERT_EQ(make("1").exit_code, 0);
  const std::string before = test::read_file(file(1, "table.json"));
  const auto again = make("1");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(count_kept(again.out), 3);
  EXPECT_EQ(test::read_file(file(1, "table.json")), before);

  // One damaged stamp, one picture that is missing: both panels are made again, to the same bytes.
  const std::string picture = test::read_file(file(1, "view_dependent.png"));
  test::write_file(file(1, "view_dependent.json"), "{\"format\": ");
  fs::remove(file(1, "view_independent.exr"));
  const auto mended = make("1");
  EXPECT_EQ(mended.exit_code, 0);
  EXPECT_EQ(count_kept(mended.out), 1);
  EXPECT_EQ(test::read_file(file(1, "view_dependent.png")), picture);
  EXPECT_TRUE(fs::exists(file(1, "view_independent.exr")));
}

TEST_F(Figure, KeepsThePointsOfCurvesAndReportsThem) {
  ASSERT_EQ(make("2").exit_code, 0);
  const std::string table_before = test::read_file(file(2, "table.json"));
  const std::string plot = test::read_file(file(2, "curve_records.svg"));
  fs::remove(file(2, "curve_records.svg"));
  EXPECT_EQ(count_kept(make("2").out), 4 + 3 * 3);
  EXPECT_EQ(test::read_file(file(2, "table.json")), table_before);
  EXPECT_EQ(test::read_file(file(2, "curve_records.svg")), plot);

  // A point whose stamp is missing is made again, to the same error.
  fs::remove(file(2, "analytic_records_200.json"));
  EXPECT_EQ(count_kept(make("2").out), 4 + 3 * 3 - 1);
  EXPECT_EQ(test::read_file(file(2, "curve_records.svg")), plot);
  EXPECT_FALSE(fs::exists(file(2, "analytic_records_200.exr")));

  const std::string page = (folder_ / "report.html").string();
  const auto report = run_vrc({"report", folder_.path().string(), "-o", page});
  ASSERT_EQ(report.exit_code, 0) << report.err;
  const std::string html = test::read_file(page);
  for (const char* over : {"records", "CPU seconds"})
    EXPECT_THAT(html, HasSubstr(fmt::format("relMSE over {}\"", over)));
}

TEST_F(Figure, MakesAgainWhatAnotherSceneChanges) {
  const fs::path scenes = folder_ / "scenes";
  fs::copy(VRC_SOURCE_DIR "/scenes", scenes, fs::copy_options::recursive);
  ASSERT_EQ(make("1", {"--scenes", scenes.string()}).exit_code, 0);
  std::string text = test::read_file(scenes / "half_box.xml");
  test::write_file(scenes / "half_box.xml",
                   text.replace(text.find("0.8, 0.78, 0.74"), 15, "0.7, 0.78, 0.74"));
  const auto again = make("1", {"--scenes", scenes.string()});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(count_kept(again.out), 0);
  EXPECT_THAT(make("1", {"--scenes", scenes.string(), "--restart"}).out, Not(HasSubstr("(kept)")));
}

TEST_F(Figure, GoesOnAfterAnInterruption) {
  {
    test::Program program({"figure", "1", "-o", folder_.path().string()});
    ASSERT_TRUE(program.wait_for_error_text("place records"));  // the reference is there
    program.send(SIGINT);
    const auto result = program.finish();
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_THAT(result.err, HasSubstr("interrupted in figure 1"));
  }
  const json partial = table(1);
  EXPECT_EQ(partial.at("groups").at(0).at("panels").size(), 1u);
  EXPECT_EQ(partial.at("measures").size(), 0u);
  const auto result = make("1");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(count_kept(result.out), 1);
  EXPECT_EQ(table(1).at("groups").at(0).at("panels").size(), 3u);
}

TEST_F(Figure, RefusesBadUsage) {
  const auto expect_refused = [](const std::vector<std::string>& words, const char* message) {
    const auto result = run_vrc(words);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  };
  const std::string folder = folder_.path().string();
  expect_refused({"figure", "13", "-o", folder}, "a figure from 1 to 12, or all");
  expect_refused({"figure", "0", "-o", folder}, "a figure from 1 to 12, or all");
  expect_refused({"figure", "-o", folder}, "is required");
  expect_refused({"figure", "1"}, "--output is required");
  expect_refused({"figure", "1", "-o", folder, "--quick", "--full"}, "excludes");
  expect_refused({"figure", "1", "-o", folder, "--scenes", folder + "/none"}, "no such folder of scenes");
  expect_refused({"figure", "1", "-o", folder, "--scenes", folder}, "half_box.xml");
  const fs::path taken = test::write_file(folder_ / "taken", "a file");
  expect_refused({"figure", "1", "-o", taken.string()}, "cannot be made");
}

TEST_F(Figure, HelpSaysWhatItWrites) {
  const auto help = run_vrc({"figure", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* text : {"--quick", "--full", "--restart", "--scenes", "--threads", "-q,--quiet",
                           "-o,--output", "table.json", ".svg", "Examples:"}) {
    EXPECT_THAT(help.out, HasSubstr(text));
  }
}

}  // namespace
}  // namespace vrc
