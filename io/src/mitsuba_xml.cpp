// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_xml.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <pugixml.hpp>
#include <set>
#include <span>

#include "core/error.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxDepth = 64;       // of nested elements, so that hostile files cannot exhaust the stack
constexpr int kMaxIncludes = 1000;  // includes can multiply: each of a chain of files naming the next twice

struct ElementRule {
  std::string_view tag;
  std::vector<std::string_view> required;
  std::vector<std::string_view> optional;
};

/// Every element that can stand in a scene. Objects that this program cannot use (media, phase
/// functions) are listed as well: they are refused later, by the object that contains them.
const std::vector<ElementRule>& element_rules() {
  static const std::vector<ElementRule> rules = [] {
    std::vector<ElementRule> list = {
        {"scene", {"version"}, {"type", "id"}},
        {"default", {"name", "value"}, {}},
        {"include", {"filename"}, {}},
        {"path", {"value"}, {}},
        {"ref", {"id"}, {"name"}},
        {"float", {"name", "value"}, {}},
        {"integer", {"name", "value"}, {}},
        {"boolean", {"name", "value"}, {}},
        {"string", {"name", "value"}, {}},
        {"vector", {"name"}, {"value", "x", "y", "z"}},
        {"point", {"name"}, {"value", "x", "y", "z"}},
        {"rgb", {"name", "value"}, {}},
        {"srgb", {"name", "value"}, {}},
        {"spectrum", {"name", "value"}, {}},
        {"transform", {"name"}, {}},
        {"matrix", {"value"}, {}},
        {"lookat", {"origin", "target"}, {"up"}},
        {"translate", {}, {"value", "x", "y", "z"}},
        {"rotate", {"angle"}, {"value", "x", "y", "z"}},
        {"scale", {}, {"value", "x", "y", "z"}},
    };
    for (const char* object : {"shape", "bsdf", "emitter", "sensor", "film", "rfilter", "sampler",
                               "integrator", "texture", "medium", "volume", "phase"}) {
      list.push_back({object, {"type"}, {"id", "name"}});
    }
    return list;
  }();
  return rules;
}

/// Line numbers, from 1, of offsets into a text.
class LineTable {
 public:
  explicit LineTable(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') line_ends_.push_back(i);
    }
  }
  [[nodiscard]] std::size_t line(std::ptrdiff_t offset) const {
    const auto position = static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0));
    const auto end = std::lower_bound(line_ends_.begin(), line_ends_.end(), position);
    return static_cast<std::size_t>(end - line_ends_.begin()) + 1;
  }

 private:
  std::vector<std::size_t> line_ends_;
};

struct Document {
  std::string file;
  pugi::xml_document xml;
  LineTable lines;
};

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (fs::is_directory(path) || !in) {
    throw InputError(path.string(), 0, "cannot open the scene file; check the name and its permissions");
  }
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

Document parse_document(const fs::path& path) {
  const std::string text = read_text(path);
  Document document{path.string(), {}, LineTable(text)};
  const pugi::xml_parse_result result =
      document.xml.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    throw InputError(document.file, document.lines.line(result.offset),
                     fmt::format("not well-formed XML ({}); correct the markup here or just before",
                                 result.description()));
  }
  return document;
}

bool is_name_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Expands one scene and its includes, in document order: a parameter is known from its <default> on.
class Loader {
 public:
  Loader(const std::map<std::string, std::string>& defines, MitsubaReport& report)
      : defines_(defines), parameters_(defines), report_(report) {}

  MitsubaXml load(const fs::path& path) {
    result_.search_folders.push_back(path.parent_path());
    result_.files.push_back(path);
    open_files_.push_back(fs::weakly_canonical(path));
    const Document document = parse_document(path);
    const pugi::xml_node root = root_of(document);
    result_.root = convert(document, root);
    if (result_.root.tag != "scene") fail(result_.root, "the outermost element must be <scene>");
    check_version(result_.root);
    add_children(document, root, result_.root, 1);
    warn_unused_defines();
    return std::move(result_);
  }

 private:
  static pugi::xml_node root_of(const Document& document) {
    const pugi::xml_node root = document.xml.document_element();
    if (!root) throw InputError(document.file, 1, "no element; a scene file holds a <scene>");
    return root;
  }

  void check_version(const XmlElement& scene) {
    const std::string_view version = scene.get("version");
    const std::string_view major = version.substr(0, version.find('.'));
    if (major != "0" && major != "2" && major != "3") {
      report_.reject(scene, fmt::format("version '{}' is not known; use 0.x, 2.x or 3.x", version),
                     "read as 3.0");
    }
  }

  void warn_unused_defines() {
    for (const auto& [name, value] : defines_) {
      if (!used_.contains(name)) {
        report_.warn(fmt::format("-D {}={}: the scene uses no ${}; check the spelling", name, value, name));
      }
    }
  }

  /// The element alone, without its children.
  XmlElement convert(const Document& document, const pugi::xml_node& node) {
    XmlElement element;
    element.tag = to_snake_case(node.name());
    if (element.tag == "look_at") element.tag = "lookat";
    element.file = document.file;
    element.line = document.lines.line(node.offset_debug());
    for (const pugi::xml_attribute& attribute : node.attributes()) {
      if (element.find(attribute.name()) != nullptr) {
        fail(element, fmt::format("the attribute {} is given twice; remove one", attribute.name()));
      }
      element.attributes.emplace_back(attribute.name(), attribute.value());
    }
    for (auto& [name, value] : element.attributes) {
      value = substitute(element, value);
      if (name == "name" && element.tag != "default") value = to_snake_case(value);
    }
    return element;
  }

  /// Every $name in `text`, by the longest run of letters, digits and underscores after the sign.
  std::string substitute(const XmlElement& element, const std::string& text) {
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
      if (text[i] != '$') {
        result += text[i++];
        continue;
      }
      std::size_t end = i + 1;
      while (end < text.size() && is_name_character(text[end])) ++end;
      const std::string name = text.substr(i + 1, end - i - 1);
      const auto parameter = parameters_.find(name);
      if (parameter == parameters_.end()) {
        fail(element,
             fmt::format("the parameter ${0} has no value; put <default name=\"{0}\" value=\"...\"/> "
                         "before it or give -D {0}=...",
                         name));
      }
      used_.insert(name);
      result += parameter->second;
      i = end;
    }
    return result;
  }

  void add_children(const Document& document, const pugi::xml_node& node, XmlElement& parent, int depth) {
    if (depth > kMaxDepth)
      fail(parent, fmt::format("nested more than {} deep; flatten the scene", kMaxDepth));
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() == pugi::node_element) {
        add_element(document, child, parent, depth);
      } else if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
        report_.reject(parent,
                       fmt::format("the text '{}' stands between elements; put values into attributes",
                                   std::string_view(child.value()).substr(0, 40)));
      }
    }
  }

  void add_element(const Document& document, const pugi::xml_node& node, XmlElement& parent, int depth) {
    XmlElement element = convert(document, node);
    if (!check_attributes(element)) return;
    if (element.tag == "default") {
      parameters_.emplace(element.get("name"),
                          element.get("value"));  // The first value stays, as in Mitsuba.
    } else if (element.tag == "include") {
      include(element, parent, depth);
    } else if (element.tag == "path") {
      result_.search_folders.push_back(fs::path(element.file).parent_path() / element.get("value"));
    } else {
      add_children(document, node, element, depth + 1);
      parent.children.push_back(std::move(element));
    }
  }

  /// False when the element is to be skipped.
  bool check_attributes(XmlElement& element) {
    const auto& rules = element_rules();
    const auto rule =
        std::find_if(rules.begin(), rules.end(), [&](const ElementRule& r) { return r.tag == element.tag; });
    if (rule == rules.end()) {
      report_.reject(element, "this element is not known; remove it or use --lenient to skip it");
      return false;
    }
    for (const std::string_view name : rule->required) {
      if (element.find(name) == nullptr)
        fail(element, fmt::format("the attribute {} is missing; add it", name));
    }
    std::erase_if(element.attributes, [&](const auto& attribute) {
      const auto is = [&](std::string_view name) { return name == attribute.first; };
      if (std::any_of(rule->required.begin(), rule->required.end(), is)) return false;
      if (std::any_of(rule->optional.begin(), rule->optional.end(), is)) return false;
      report_.reject(element, fmt::format("the attribute {} is not known here; remove it", attribute.first));
      return true;
    });
    return true;
  }

  /// An included <scene> gives its children; any other element stands for itself.
  void include(const XmlElement& element, XmlElement& parent, int depth) {
    const fs::path path = resolve_file(element, std::string(element.get("filename")), result_.search_folders);
    const fs::path canonical = fs::weakly_canonical(path);
    if (std::find(open_files_.begin(), open_files_.end(), canonical) != open_files_.end()) {
      fail(element, fmt::format("the include of '{}' leads back to itself; break the cycle", path.string()));
    }
    if (++include_count_ > kMaxIncludes) {
      fail(element, fmt::format("more than {} includes; merge some files", kMaxIncludes));
    }
    open_files_.push_back(canonical);
    result_.files.push_back(path);
    const Document document = parse_document(path);
    const pugi::xml_node root = root_of(document);
    if (std::string_view(root.name()) == "scene") {
      check_version(convert(document, root));
      add_children(document, root, parent, depth + 1);
    } else {
      add_element(document, root, parent, depth + 1);
    }
    open_files_.pop_back();
  }

  std::map<std::string, std::string> defines_;
  std::map<std::string, std::string> parameters_;
  std::set<std::string> used_;
  MitsubaReport& report_;
  MitsubaXml result_;
  std::vector<fs::path> open_files_;
  int include_count_ = 0;
};

}  // namespace

MitsubaXml load_mitsuba_xml(const fs::path& path, const std::map<std::string, std::string>& defines,
                            MitsubaReport& report) {
  return Loader(defines, report).load(path);
}

}  // namespace vrc
