// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace vrc::test {

/// Whether a Chromium is on the path.
[[nodiscard]] bool has_browser();

/// Opens the page in a window of this size, lets its scripts run, and returns the document as they leave it.
/// The browser's own files go into `scratch`.
[[nodiscard]] std::string dump_dom(const std::filesystem::path& page, const std::filesystem::path& scratch,
                                   int width, int height);

}  // namespace vrc::test
