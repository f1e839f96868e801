// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_properties.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "mitsuba_values.h"

namespace vrc {
namespace {

void collect_ids(const XmlElement& element, std::map<std::string, const XmlElement*, std::less<>>& objects) {
  const std::string* id = element.tag == "ref" ? nullptr : element.find("id");
  if (id != nullptr) {
    const auto [other, is_new] = objects.emplace(*id, &element);
    if (!is_new) {
      fail(element, fmt::format("the id '{}' is already used at {}:{}; rename one of them", *id,
                                other->second->file, other->second->line));
    }
  }
  for (const XmlElement& child : element.children) collect_ids(child, objects);
}

}  // namespace

MitsubaContext::MitsubaContext(const MitsubaXml& xml, MitsubaReport& mitsuba_report)
    : report(mitsuba_report), search_folders(xml.search_folders), files(xml.files) {
  collect_ids(xml.root, objects);
}

const XmlElement* MitsubaContext::resolve(const XmlElement& element) const {
  if (element.tag != "ref") return &element;
  const auto object = objects.find(element.get("id"));
  if (object != objects.end()) return object->second;
  report.reject(element, "no object has this id; correct it or define the object");
  return nullptr;
}

Properties::Properties(const XmlElement& element, MitsubaContext& context)
    : element_(element), context_(context) {
  for (const XmlElement& child : element.children) {
    const std::string_view name = child.get("name");
    const auto same_name = [&](const Child& other) { return !name.empty() && other.name == name; };
    if (std::any_of(children_.begin(), children_.end(), same_name)) {
      fail(child, fmt::format("{} is given twice; remove one", name));
    }
    if (const XmlElement* object = context.resolve(child)) children_.push_back({object, name});
  }
}

const XmlElement* Properties::take(std::string_view name, std::initializer_list<std::string_view> tags,
                                   std::string_view texture_action) {
  const auto child =
      std::find_if(children_.begin(), children_.end(), [&](const Child& c) { return c.name == name; });
  if (child == children_.end()) return nullptr;
  child->used = true;
  if (std::find(tags.begin(), tags.end(), child->element->tag) != tags.end()) return child->element;
  if (child->element->tag != "texture") {
    fail(*child->element, fmt::format("wrong kind of value for {}; write <{}>", name, *tags.begin()));
  }
  context_.report.reject(*child->element, "textures are not supported; use a constant value", texture_action);
  return nullptr;
}

bool Properties::has(std::string_view name) const {
  return std::any_of(children_.begin(), children_.end(), [&](const Child& c) { return c.name == name; });
}

std::optional<double> Properties::number(std::string_view name) {
  const XmlElement* element = take(name, {"float", "integer"}, "the default is used");
  if (element == nullptr) return std::nullopt;
  return parse_number(*element);
}

std::optional<int> Properties::integer(std::string_view name) {
  const XmlElement* element = take(name, {"integer", "float"}, "the default is used");
  if (element == nullptr) return std::nullopt;
  const double value = parse_number(*element);
  if (value != std::floor(value) || std::abs(value) > 1e9) {
    fail(*element, fmt::format("'{}' should be a whole number", element->get("value")));
  }
  return static_cast<int>(value);
}

std::optional<bool> Properties::boolean(std::string_view name) {
  const XmlElement* element = take(name, {"boolean"}, "the default is used");
  if (element == nullptr) return std::nullopt;
  const std::string_view value = element->get("value");
  if (value == "true" || value == "True") return true;
  if (value == "false" || value == "False") return false;
  fail(*element, fmt::format("'{}' should be true or false", value));
}

std::optional<std::string> Properties::string(std::string_view name) {
  const XmlElement* element = take(name, {"string"}, "the default is used");
  if (element == nullptr) return std::nullopt;
  return std::string(element->get("value"));
}

std::optional<Vec3> Properties::vector(std::string_view name) {
  const XmlElement* element = take(name, {"vector", "point"}, "the default is used");
  if (element == nullptr) return std::nullopt;
  return parse_vector(*element);
}

std::optional<Rgb> Properties::color(std::string_view name) {
  if (!has(name)) return std::nullopt;
  const XmlElement* element = take(name, {"rgb", "srgb", "spectrum", "float", "integer"}, "grey 0.5 is used");
  return element == nullptr ? Rgb(Rgb::Constant(0.5f)) : parse_color(*element);
}

std::optional<Mat4> Properties::transform(std::string_view name) {
  const XmlElement* element = take(name, {"transform"}, "the default is used");
  if (element == nullptr) return std::nullopt;
  return parse_transform(*element);
}

std::vector<const XmlElement*> Properties::objects(std::string_view tag) {
  std::vector<const XmlElement*> found;
  for (Child& child : children_) {
    if (child.used || child.element->tag != tag) continue;
    child.used = true;
    found.push_back(child.element);
  }
  return found;
}

void Properties::ignore(std::initializer_list<std::string_view> names) {
  for (Child& child : children_) {
    if (std::find(names.begin(), names.end(), child.name) != names.end()) child.used = true;
  }
}

void Properties::finish() {
  for (const Child& child : children_) {
    if (child.used) continue;
    context_.report.reject(
        *child.element,
        fmt::format("not understood in {}; remove it or use --lenient to skip it", element_.label()));
  }
}

}  // namespace vrc
