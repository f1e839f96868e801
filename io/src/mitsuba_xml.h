// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mitsuba_element.h"

namespace vrc {

/// A scene file with everything that it includes.
struct MitsubaXml {
  XmlElement root;                                    ///< The <scene>; no default, include or path is left.
  std::vector<std::filesystem::path> search_folders;  ///< The scene's folder, then its <path> elements.
  std::vector<std::filesystem::path> files;           ///< The scene's and those that it includes.
};

/// Element names, attributes and nesting are checked here; types and properties are not. `defines`
/// override <default>; one that nothing uses is a warning.
/// Throws InputError on XML syntax errors, unknown elements or attributes, parameters without a value,
/// include cycles and missing files.
[[nodiscard]] MitsubaXml load_mitsuba_xml(const std::filesystem::path& path,
                                          const std::map<std::string, std::string>& defines,
                                          MitsubaReport& report);

}  // namespace vrc
