// SPDX-License-Identifier: GPL-3.0-or-later
#include "report_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "app/version.h"
#include "core/error.h"
#include "core/image_error.h"
#include "io/base64.h"
#include "io/color.h"
#include "io/deflate.h"
#include "io/image_io.h"
#include "io/xml_text.h"
#include "report_assets.h"
#include "report_pack.h"
#include "report_records.h"
#include "report_tables.h"

namespace vrc {
namespace {

using nlohmann::ordered_json;

/// Elements of the page that hold compressed bytes; equal ones are kept once.
class DataBlocks {
 public:
  /// The element's id.
  std::string add(const std::string& bytes) {
    const std::string text = base64(deflated(bytes));
    const auto [found, is_new] = ids_.try_emplace(text, fmt::format("data-{}", ids_.size()));
    if (is_new)
      html_ += fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", found->second,
                           text);
    return found->second;
  }
  [[nodiscard]] const std::string& html() const { return html_; }

 private:
  std::map<std::string, std::string> ids_;  // by content
  std::string html_;
};

/// JSON in an element of the page, which `</script>` in a string must not end.
std::string json_element(const std::string& id, const ordered_json& value) {
  std::string text;
  for (const char c : value.dump(-1, ' ', false, ordered_json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id, text);
}

Image read_picture(const std::filesystem::path& path) {
  const Image whole = read_image(path);
  try {
    return rgb_of(whole);
  } catch (const InputError& error) {
    throw InputError(path.string(), 0, error.what());
  }
}

/// Powers of two, in halves, that bring nine tenths of a picture's pixels below a luminance that a screen
/// shows as light grey.
double fitting_exposure(const Image& picture) {
  constexpr double kShare = 0.9, kLightGrey = 0.5;
  Image luminances(picture.width, picture.height, {"Y"});
  for (std::size_t p = 0; p < picture.pixel_count(); ++p)
    luminances.pixels[p] = luminance(&picture.pixels[3 * p]);
  const double bright = percentiles(luminances, std::array{kShare}).front();
  if (!(bright > 0.0)) return 0.0;
  return std::clamp(0.5 * std::round(2.0 * std::log2(kLightGrey / bright)), -8.0, 8.0);
}

/// What the script knows of a group; its pictures and records go into `data`.
ordered_json group_json(const ReportGroup& group, DataBlocks& data) {
  ordered_json result{{"name", group.name}, {"panels", ordered_json::array()}};
  int width = 0, height = 0;
  for (const ReportPanel& panel : group.panels) {
    const Image picture = read_picture(panel.image);
    if (width == 0) {
      width = picture.width;
      height = picture.height;
      result["exposure"] = fitting_exposure(picture);
    }
    if (picture.width != width || picture.height != height) {
      throw InputError(
          panel.image.string(), 0,
          fmt::format("has {}x{} pixels, but {} has {}x{}; pictures of a group must have one size",
                      picture.width, picture.height, group.panels.front().image.string(), width, height));
    }
    const PackedPicture packed = pack_picture(picture);
    ordered_json entry{{"name", panel.name}, {"data", data.add(packed.bytes)}, {"exponent", packed.exponent}};
    if (panel.reference) entry["reference"] = *panel.reference;
    for (const auto& [key, value] : panel.ours) {
      if (key == "relmse") entry["note"] = "relMSE " + value;
    }
    if (panel.records) {
      const PackedRecords records = pack_records(*panel.records, width, height);
      entry["records"] = {
          {"data", data.add(records.bytes)}, {"count", records.count}, {"columns", records.columns}};
    }
    result["panels"].push_back(std::move(entry));
  }
  result["width"] = width;
  result["height"] = height;
  return result;
}

/// The colours of errors from 0 to 1, "rrggbb" each, so that pages and `vrc compare` agree.
std::string color_map() {
  constexpr int kColors = 256;
  std::string text;
  for (int i = 0; i < kColors; ++i) {
    for (const std::uint8_t c : map_color8(i / (kColors - 1.0))) text += fmt::format("{:02x}", c);
  }
  return text;
}

std::string commands_html(const ReportGroup& group) {
  std::string items;
  for (const ReportPanel& panel : group.panels) {
    if (!panel.command.empty())
      items += fmt::format("<dt>{}</dt><dd><code>{}</code></dd>\n", xml_escaped(panel.name),
                           xml_escaped(panel.command));
  }
  if (items.empty()) return "";
  return "<details class=\"commands\"><summary>How to make them</summary>\n<dl>\n" + items +
         "</dl>\n</details>\n";
}

std::string curves_html(const std::vector<LabelledPlot>& curves) {
  std::string html;
  for (const LabelledPlot& c : curves) {
    html += fmt::format("<div class=\"plot\" role=\"img\" aria-label=\"{}\">\n",
                        xml_escaped(fmt::format("{}: {} over {}", c.panel.title, c.y_label, c.x_label)));
    html += plot_svg(c, PlotPaper::kPage) + "</div>\n";
  }
  if (html.empty()) return "";
  return "<section class=\"group\">\n<h3>Convergence</h3>\n<div class=\"plots\">\n" + html +
         "</div>\n</section>\n";
}

struct Verdict {
  std::size_t held = 0, checked = 0;
};

Verdict verdict_of(const ReportFigure& figure) {
  Verdict verdict;
  for (const ReportMeasure& m : figure.measures) {
    verdict.checked += m.holds ? 1 : 0;
    verdict.held += m.holds.value_or(false) ? 1 : 0;
  }
  return verdict;
}

std::string figure_html(const ReportFigure& figure, std::size_t index) {
  std::string html = fmt::format(
      "<section class=\"figure\" id=\"figure-{0}\" aria-labelledby=\"title-{0}\" tabindex=\"-1\">\n"
      "<header><p class=\"number\">Figure {1}{2}</p>\n<h2 id=\"title-{0}\">{3}</h2>\n",
      index, figure.number, figure.size.empty() ? "" : " <span>" + xml_escaped(figure.size) + "</span>",
      xml_escaped(figure.title));
  if (!figure.claim.empty()) html += fmt::format("<p class=\"claim\">{}</p>\n", xml_escaped(figure.claim));
  html += "</header>\n";
  for (std::size_t g = 0; g < figure.groups.size(); ++g) {
    const ReportGroup& group = figure.groups[g];
    if (group.panels.empty()) continue;
    html += fmt::format(
        "<section class=\"group\">\n<h3>{}</h3>\n<div class=\"viewer\" data-group=\"{}.{}\"></div>\n",
        xml_escaped(group.name), index, g);
    html += panel_table(group) + commands_html(group) + "</section>\n";
  }
  html += curves_html(figure.curves) + measure_table(figure.measures);
  return html + "</section>\n";
}

std::string contents_html(std::span<const ReportFigure> figures) {
  std::string links, sections;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Verdict verdict = verdict_of(figures[i]);
    const char* mark = verdict.checked == 0 ? "" : verdict.held == verdict.checked ? "\u2713" : "\u2717";
    links +=
        fmt::format("<li><a href=\"#figure-{}\"><b>{}</b> <span>{}</span> <i>{}</i></a></li>\n", i,
                    figures[i].number, xml_escaped(figures[i].title),
                    verdict.checked == 0 ? "" : fmt::format("{} {}/{}", mark, verdict.held, verdict.checked));
    sections += figure_html(figures[i], i);
  }
  return "<nav aria-label=\"Figures\"><ol>\n" + links + "</ol></nav>\n" + sections;
}

/// Replaces {{words}} of the template; what takes their place is not looked at again.
std::string filled(std::string_view page, const std::map<std::string, std::string_view, std::less<>>& words) {
  std::string result;
  for (;;) {
    const std::size_t begin = page.find("{{");
    const std::size_t end = page.find("}}", begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) return result += page;
    result += page.substr(0, begin);
    const std::string_view word = page.substr(begin + 2, end - begin - 2);
    const auto found = words.find(word);
    VRC_CHECK(found != words.end(), "the page names '{}'", word);
    result += found->second;
    page.remove_prefix(end + 2);
  }
}

std::string page_title(std::span<const ReportFigure> figures) {
  if (figures.size() == 1) return fmt::format("Figure {}: {}", figures.front().number, figures.front().title);
  return "View-dependent radiance caching on meshes";
}

}  // namespace

std::string report_page(std::span<const ReportFigure> figures) {
  DataBlocks data;
  ordered_json manifest{
      {"colorMap", color_map()}, {"errorOffset", kRelativeErrorOffset}, {"figures", ordered_json::array()}};
  for (const ReportFigure& figure : figures) {
    ordered_json groups = ordered_json::array();
    for (const ReportGroup& group : figure.groups) groups.push_back(group_json(group, data));
    manifest["figures"].push_back({{"groups", std::move(groups)}});
  }
  const std::string title = xml_escaped(page_title(figures));
  const std::string contents = contents_html(figures);
  const std::string blocks = json_element("manifest", manifest) + data.html();
  return filled(page_template(), {{"title", title},
                                  {"version", kVersion},
                                  {"style", page_style()},
                                  {"contents", contents},
                                  {"data", blocks},
                                  {"script", page_script()}});
}

}  // namespace vrc
