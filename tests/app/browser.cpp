// SPDX-License-Identifier: GPL-3.0-or-later
#include "browser.h"

#include <fmt/format.h>

#include <cstdlib>
#include <optional>
#include <sstream>

#include "support.h"

namespace vrc::test {
namespace fs = std::filesystem;
namespace {

std::optional<fs::path> find_browser() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
      if (fs::exists(fs::path(folder) / name)) return fs::path(folder) / name;
    }
  }
  return std::nullopt;
}

}  // namespace

bool has_browser() { return find_browser().has_value(); }

std::string dump_dom(const fs::path& page, const fs::path& scratch, int width, int height) {
  const fs::path out = scratch / "dom.html";
  const std::string command = fmt::format(
      "timeout 240 '{}' --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --hide-scrollbars "
      "--user-data-dir='{}' --window-size={},{} --virtual-time-budget=60000 --dump-dom 'file://{}' "
      ">'{}' 2>/dev/null",
      find_browser()->string(), (scratch / "profile").string(), width, height, page.string(), out.string());
  if (std::system(command.c_str()) != 0) return "the browser failed: " + command;  // NOLINT(cert-env33-c)
  return read_file(out);
}

}  // namespace vrc::test
