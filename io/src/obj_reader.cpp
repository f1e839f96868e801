// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/obj_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <unordered_map>

#include "core/error.h"
#include "soup_normals.h"
#include "text_file.h"

namespace vrc {
namespace {

// Statements that say nothing about the surface.
constexpr std::array<std::string_view, 16> kIgnored{
    "o",     "g",     "s",      "mg",     "lod",        "bevel",     "c_interp", "d_interp",
    "ctech", "stech", "usemap", "maplib", "shadow_obj", "trace_obj", "call",     "csh"};

// Free-form curves and surfaces [Wavefront OBJ 3.0], with the superseded spellings.
constexpr std::array<std::string_view, 20> kFreeForm{
    "vp",   "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim",
    "hole", "scrv",   "sp",  "end",  "con",  "bsp",  "bzp",   "cdc",  "cdp",  "res"};

template <std::size_t N>
bool contains(const std::array<std::string_view, N>& names, std::string_view keyword) {
  return std::find(names.begin(), names.end(), keyword) != names.end();
}

// What a corner of a face refers to, in the order in which its word spells it.
enum Attribute : std::size_t { kPosition, kUv, kNormal };
constexpr std::array<const char*, 3> kAttributeName{"vertex", "texture coordinate", "normal"};
constexpr std::array<const char*, 3> kAttributeStatement{"v", "vt", "vn"};

// An index to something that the file had not defined yet when a face used it.
struct ForwardReference {
  std::size_t line;
  std::uint32_t index;
  Attribute attribute;
};

class ObjParser {
 public:
  ObjParser(const std::filesystem::path& path, std::string_view text)
      : path_(path), scanner_(path.string(), text, TextSyntax::kWavefront) {
    file_.soup.source = path.string();
    file_.soup.face_begin.push_back(0);
  }

  ObjFile parse() && {
    while (scanner_.next_line()) statement(scanner_.word());
    finish();
    return std::move(file_);
  }

 private:
  void statement(std::string_view keyword);
  void position();
  void normal();
  void uv();
  void face();
  void corner(std::string_view word);
  std::uint32_t resolve(std::string_view word, std::string_view part, Attribute attribute);
  void use_material();
  void material_libraries();
  void skip_kind(const std::string& kind);
  std::size_t numbers(std::array<double, 8>& values, const char* usage);
  [[nodiscard]] std::size_t count(Attribute attribute) const;
  void finish();

  std::filesystem::path path_;
  TextScanner scanner_;
  ObjFile file_;
  std::vector<ForwardReference> forward_;
  std::unordered_map<std::string, std::uint32_t> material_index_;
  std::string material_name_;
  std::uint32_t material_ = kInvalidIndex;  // Until a face uses `material_name_`.
  bool any_uv_ = false;
  bool any_normal_ = false;
  std::size_t zero_normal_line_ = 0;
  std::map<std::string, std::pair<std::size_t, std::size_t>> skipped_;  // Kind to first line and number.
};

void ObjParser::statement(std::string_view keyword) {
  if (keyword == "v") return position();
  if (keyword == "f" || keyword == "fo") return face();
  if (keyword == "vn") return normal();
  if (keyword == "vt") return uv();
  if (keyword == "usemtl") return use_material();
  if (keyword == "mtllib") return material_libraries();
  if (keyword == "p") return skip_kind("points ('p')");
  if (keyword == "l") return skip_kind("lines ('l')");
  if (contains(kFreeForm, keyword)) return skip_kind("free-form curves and surfaces");
  if (contains(kIgnored, keyword)) return;
  scanner_.fail(in_quotes(keyword) +
                " is not a statement of OBJ; remove the line or check that this is an OBJ file");
}

// All numbers that are left on the line.
std::size_t ObjParser::numbers(std::array<double, 8>& values, const char* usage) {
  std::size_t n = 0;
  while (const std::optional<double> value = scanner_.number()) {
    if (n == values.size()) scanner_.fail(fmt::format("too many numbers; write '{}'", usage));
    values[n++] = *value;
  }
  return n;
}

void ObjParser::position() {
  std::array<double, 8> values;
  constexpr const char* kUsage = "v x y z";
  const std::size_t n = numbers(values, kUsage);
  // With a weight, a colour, or both, which are of no use here.
  if (n != 3 && n != 4 && n != 6 && n != 7) {
    scanner_.fail(fmt::format("'v' with {} number{}; write '{}'", n, n == 1 ? "" : "s", kUsage));
  }
  const Vec3 p(values[0], values[1], values[2]);
  if (p.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    scanner_.fail(
        fmt::format("'v {:g} {:g} {:g}' is further out than 1e18; use smaller units", p[0], p[1], p[2]));
  }
  file_.soup.positions.push_back(p);
}

void ObjParser::normal() {
  std::array<double, 8> values;
  const std::size_t n = numbers(values, "vn x y z");
  if (n != 3) scanner_.fail(fmt::format("'vn' with {} number{}; write 'vn x y z'", n, n == 1 ? "" : "s"));
  const Vec3 normal(values[0], values[1], values[2]);
  if (normal.isZero(0.0) && zero_normal_line_ == 0) zero_normal_line_ = scanner_.line();
  file_.soup.normals.push_back(normal);
}

void ObjParser::uv() {
  std::array<double, 8> values;
  const std::size_t n = numbers(values, "vt u v");
  if (n < 1 || n > 3) scanner_.fail(fmt::format("'vt' with {} numbers; write 'vt u v'", n));
  file_.soup.uvs.emplace_back(values[0], n > 1 ? values[1] : 0.0);
}

void ObjParser::face() {
  PolygonSoup& soup = file_.soup;
  const std::size_t before = soup.corner_position.size();
  for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) corner(word);
  const std::size_t corners = soup.corner_position.size() - before;
  if (corners < 3) {
    scanner_.fail(
        fmt::format("'f' with {} corner{}; a face needs at least 3", corners, corners == 1 ? "" : "s"));
  }
  if (soup.corner_position.size() >= kInvalidIndex) scanner_.fail("more than 2^32 corners; split the mesh");
  soup.face_begin.push_back(static_cast<std::uint32_t>(soup.corner_position.size()));

  if (material_ == kInvalidIndex) {
    const auto next = static_cast<std::uint32_t>(file_.material_names.size());
    const auto [entry, is_new] = material_index_.try_emplace(material_name_, next);
    if (is_new) file_.material_names.push_back(material_name_);
    material_ = entry->second;
  }
  soup.face_material.push_back(material_);
}

// One of v, v/t, v//n, v/t/n; an index that is left out after its slash is absent.
void ObjParser::corner(std::string_view word) {
  std::array<std::string_view, 3> parts;
  std::size_t part = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (word[i] != '/') continue;
    parts[part++] = word.substr(begin, i - begin);
    begin = i + 1;
    if (part == parts.size()) {
      scanner_.fail(in_quotes(word) + " is not a corner of a face; write v, v/t, v//n or v/t/n");
    }
  }
  parts[part] = word.substr(begin);

  PolygonSoup& soup = file_.soup;
  soup.corner_position.push_back(resolve(word, parts[kPosition], kPosition));
  soup.corner_uv.push_back(parts[kUv].empty() ? kInvalidIndex : resolve(word, parts[kUv], kUv));
  soup.corner_normal.push_back(parts[kNormal].empty() ? kInvalidIndex
                                                      : resolve(word, parts[kNormal], kNormal));
  any_uv_ |= !parts[kUv].empty();
  any_normal_ |= !parts[kNormal].empty();
}

// The index from 0: positive ones count from the file's first, negative ones back from the latest.
std::uint32_t ObjParser::resolve(std::string_view word, std::string_view part, Attribute attribute) {
  std::int64_t index = 0;
  const char* end = part.data() + part.size();
  const auto [stop, error] = std::from_chars(part.data(), end, index);
  if (part.empty() || stop != end || error == std::errc::invalid_argument) {
    scanner_.fail(in_quotes(word) +
                  " is not a corner of a face; write v, v/t, v//n or v/t/n with whole numbers");
  }
  if (error == std::errc() && index == 0) {
    scanner_.fail(in_quotes(word) + " has an index 0; OBJ counts from 1, or from -1 backwards");
  }
  const auto defined = static_cast<std::int64_t>(count(attribute));
  const std::int64_t absolute = index > 0 ? index - 1 : defined + index;
  if (error != std::errc() || absolute < 0 || absolute >= std::int64_t{kInvalidIndex}) {
    scanner_.fail(
        fmt::format("{} refers to a {} that does not exist (there are {} so far); correct the index",
                    in_quotes(word), kAttributeName[attribute], defined));
  }
  const auto result = static_cast<std::uint32_t>(absolute);
  if (absolute >= defined) forward_.push_back({scanner_.line(), result, attribute});
  return result;
}

std::size_t ObjParser::count(Attribute attribute) const {
  if (attribute == kPosition) return file_.soup.positions.size();
  return attribute == kUv ? file_.soup.uvs.size() : file_.soup.normals.size();
}

void ObjParser::use_material() {
  material_name_ = scanner_.rest_of_line();
  material_ = kInvalidIndex;
}

// Several names may stand on a line, and one name may contain blanks: the files decide.
void ObjParser::material_libraries() {
  const std::string line = scanner_.rest_of_line();
  if (line.empty()) scanner_.fail("'mtllib' without a file name; name the MTL file or remove the line");
  const std::filesystem::path folder = path_.parent_path();
  const auto exists = [&](const std::filesystem::path& name) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(folder / name, ignored);
  };
  const std::vector<std::string_view> words = split_words(line);
  std::vector<std::filesystem::path> names(words.begin(), words.end());
  if (!std::all_of(names.begin(), names.end(), exists) && exists(line)) names = {line};
  auto& libraries = file_.material_libraries;
  for (const std::filesystem::path& name : names) {
    const std::filesystem::path library = folder / name;
    if (std::find(libraries.begin(), libraries.end(), library) == libraries.end())
      libraries.push_back(library);
  }
}

void ObjParser::skip_kind(const std::string& kind) {
  auto& [first_line, number] = skipped_[kind];
  if (number++ == 0) first_line = scanner_.line();
}

void ObjParser::finish() {
  PolygonSoup& soup = file_.soup;
  const std::string source = soup.source;
  for (const ForwardReference& reference : forward_) {
    const std::size_t defined = count(reference.attribute);
    if (reference.index < defined) continue;
    throw InputError(source, reference.line,
                     fmt::format("the face refers to {} {}, but the file has {} ('{}'); correct the index",
                                 kAttributeName[reference.attribute], std::size_t{reference.index} + 1,
                                 defined, kAttributeStatement[reference.attribute]));
  }
  if (soup.face_count() == 0) {
    throw InputError(source, 0,
                     "no faces ('f'); only surfaces can be rendered, so export the mesh with its faces");
  }

  if (!any_uv_) {
    soup.uvs.clear();
    soup.corner_uv.clear();
  }
  if (!any_normal_) {
    soup.normals.clear();
    soup.corner_normal.clear();
  }
  if (file_.material_names.size() == 1) soup.face_material.clear();
  for (const auto& [kind, where] : skipped_) {
    file_.warnings.push_back(fmt::format("{}:{}: {} are left out ({} statement{})", source, where.first, kind,
                                         where.second, where.second == 1 ? "" : "s"));
  }
  if (const std::size_t zero_count = normalize_normals(soup); zero_count > 0) {
    file_.warnings.push_back(fmt::format("{}:{}: zero normals are taken as absent ({} 'vn')", source,
                                         zero_normal_line_, zero_count));
  }
}

}  // namespace

ObjFile read_obj(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  return ObjParser(path, without_byte_order_mark(text)).parse();
}

}  // namespace vrc
