// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/camera_path.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "text_file.h"

namespace vrc {

std::vector<Camera> read_camera_path(const std::filesystem::path& path, const Camera& lens) {
  const std::string text = read_whole_file(path);
  TextScanner scanner(path.string(), without_byte_order_mark(text), TextSyntax::kWavefront);
  const double fov = 2.0 * std::atan(lens.tan_half_width) * 180.0 / kPi;
  std::vector<Camera> cameras;
  while (scanner.next_line()) {
    std::vector<double> numbers;
    while (const auto number = scanner.number()) numbers.push_back(*number);
    if (numbers.size() != 6 && numbers.size() != 9) {
      scanner.fail(
          fmt::format("{} numbers; a camera has six (origin, target) or nine (and up)", numbers.size()));
    }
    const auto vector = [&](std::size_t i) { return Vec3(numbers[i], numbers[i + 1], numbers[i + 2]); };
    try {
      cameras.push_back(look_at(vector(0), vector(3), numbers.size() == 9 ? vector(6) : lens.up, fov,
                                lens.width, lens.height));
    } catch (const InputError& error) {
      scanner.fail(error.what());
    }
  }
  if (cameras.empty())
    throw InputError(path.string(), 0, "no cameras; give one a line, as ox oy oz tx ty tz");
  return cameras;
}

}  // namespace vrc
