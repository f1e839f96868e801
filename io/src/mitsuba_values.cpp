// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_values.h"

#include <charconv>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "transport/camera.h"

namespace vrc {
namespace {

/// Numbers separated by white space or commas.
std::vector<double> parse_numbers(const XmlElement& element, std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,";
  std::vector<double> numbers;
  for (std::size_t begin = text.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
    std::size_t end = text.find_first_of(kSeparators, begin);
    if (end == std::string_view::npos) end = text.size();
    const std::string_view token = text.substr(begin, end - begin);
    const std::string_view digits = token.starts_with('+') ? token.substr(1) : token;
    double number = 0.0;
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || rest != digits.data() + digits.size() || !std::isfinite(number)) {
      fail(element, fmt::format("'{}' is not a finite number; correct it", token));
    }
    numbers.push_back(number);
    begin = text.find_first_not_of(kSeparators, end);
  }
  return numbers;
}

double parse_attribute(const XmlElement& element, std::string_view name, double fallback) {
  const std::string* text = element.find(name);
  if (text == nullptr) return fallback;
  const std::vector<double> numbers = parse_numbers(element, *text);
  if (numbers.size() != 1) fail(element, fmt::format("{} = '{}' should be one number", name, *text));
  return numbers[0];
}

Vec3 parse_triple(const XmlElement& element, std::string_view name) {
  const std::vector<double> numbers = parse_numbers(element, element.get(name));
  if (numbers.size() != 3) {
    fail(element, fmt::format("{} = '{}' should be three numbers", name, element.get(name)));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

double srgb_to_linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

std::vector<double> parse_hex_color(const XmlElement& element, std::string_view text) {
  std::vector<double> channels;
  for (std::size_t i = 1; i + 2 <= text.size() && text.size() == 7; i += 2) {
    int byte = 0;
    const auto [rest, error] = std::from_chars(text.data() + i, text.data() + i + 2, byte, 16);
    if (error == std::errc() && rest == text.data() + i + 2 && byte >= 0) channels.push_back(byte / 255.0);
  }
  if (channels.size() != 3) fail(element, fmt::format("'{}' is not a colour; write #rrggbb", text));
  return channels;
}

Mat4 parse_matrix(const XmlElement& element) {
  const std::vector<double> numbers = parse_numbers(element, element.get("value"));
  Mat4 matrix = Mat4::Identity();
  if (numbers.size() != 16 && numbers.size() != 9) {
    fail(element, fmt::format("{} numbers; a matrix has 16 or 9, row by row", numbers.size()));
  }
  const int size = numbers.size() == 16 ? 4 : 3;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) matrix(row, column) = numbers[size * row + column];
  }
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    fail(element, "the last row must be 0 0 0 1; perspective transforms are not supported");
  }
  return matrix;
}

/// Any direction will do where the scene gives no `up`: y, or z for a view along y.
Vec3 lookat_up(const XmlElement& element, const Vec3& view) {
  if (element.find("up") != nullptr) return parse_triple(element, "up");
  return std::abs(view.y()) > 0.999 * view.norm() ? Vec3::UnitZ() : Vec3::UnitY();
}

/// Columns: left, up, view, origin. Mitsuba's camera looks along its local +z.
Mat4 parse_lookat(const XmlElement& element) {
  const Vec3 origin = parse_triple(element, "origin");
  const Vec3 target = parse_triple(element, "target");
  try {
    const Camera camera = look_at(origin, target, lookat_up(element, target - origin), 90.0, 1, 1);
    Mat4 matrix = Mat4::Identity();
    matrix.block<3, 4>(0, 0) << -camera.right, camera.up, camera.forward, camera.origin;
    return matrix;
  } catch (const InputError& error) {
    fail(element, error.what());
  }
}

Mat4 parse_rotate(const XmlElement& element) {
  const Vec3 axis = parse_vector(element);
  if (!(axis.norm() > 0.0)) fail(element, "the rotation has no axis; set x, y or z to 1");
  const double angle = parse_attribute(element, "angle", 0.0) * kPi / 180.0;
  return Eigen::Affine3d(Eigen::AngleAxisd(angle, axis.normalized())).matrix();
}

Mat4 parse_scale(const XmlElement& element) {
  const std::string* value = element.find("value");
  const std::vector<double> numbers = value ? parse_numbers(element, *value) : std::vector<double>();
  const Vec3 factors = numbers.size() == 1 ? Vec3(Vec3::Constant(numbers[0])) : parse_vector(element, 1.0);
  return Eigen::Affine3d(Eigen::Scaling(factors)).matrix();
}

Mat4 parse_operation(const XmlElement& element) {
  if (element.tag == "matrix") return parse_matrix(element);
  if (element.tag == "lookat") return parse_lookat(element);
  if (element.tag == "rotate") return parse_rotate(element);
  if (element.tag == "scale") return parse_scale(element);
  if (element.tag == "translate")
    return Eigen::Affine3d(Eigen::Translation3d(parse_vector(element))).matrix();
  fail(element, "not an operation of a transform; use matrix, lookat, translate, rotate or scale");
}

}  // namespace

double parse_number(const XmlElement& element) {
  const std::vector<double> numbers = parse_numbers(element, element.get("value"));
  if (numbers.size() != 1) fail(element, fmt::format("'{}' should be one number", element.get("value")));
  return numbers[0];
}

Vec3 parse_vector(const XmlElement& element, double fallback) {
  if (element.find("value") != nullptr) return parse_triple(element, "value");
  return {parse_attribute(element, "x", fallback), parse_attribute(element, "y", fallback),
          parse_attribute(element, "z", fallback)};
}

Rgb parse_color(const XmlElement& element) {
  const std::string_view text = element.get("value");
  const bool is_hex = text.starts_with('#');
  const std::vector<double> numbers = is_hex ? parse_hex_color(element, text) : parse_numbers(element, text);
  const bool is_triple = numbers.size() == 3 && (element.tag == "rgb" || element.tag == "srgb" || is_hex);
  if (numbers.size() != 1 && !is_triple) {
    fail(element,
         fmt::format("'{}' is not a colour; write <rgb> with three numbers or #rrggbb, or one number", text));
  }
  Rgb color;
  for (int channel = 0; channel < 3; ++channel) {
    const double number = numbers[numbers.size() == 1 ? 0 : channel];
    if (number < 0.0) fail(element, fmt::format("the colour '{}' is negative; use 0 or more", text));
    color[channel] = static_cast<float>(is_hex || element.tag == "srgb" ? srgb_to_linear(number) : number);
  }
  if (!color.allFinite()) fail(element, fmt::format("the colour '{}' is too large", text));
  return color;
}

Mat4 parse_transform(const XmlElement& element) {
  Mat4 transform = Mat4::Identity();
  for (const XmlElement& operation : element.children) transform = parse_operation(operation) * transform;
  const Mat3 linear = transform.topLeftCorner<3, 3>();
  // Compared with the product of the column lengths, so that small scenes are not taken for flat ones.
  const double volume = linear.col(0).norm() * linear.col(1).norm() * linear.col(2).norm();
  if (!transform.allFinite() || !(std::abs(linear.determinant()) > 1e-12 * volume)) {
    fail(element, "the transform is singular or not finite; scale by numbers other than 0");
  }
  return transform;
}

}  // namespace vrc
