// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_sensor.h"

#include <charconv>
#include <cmath>

#include "core/error.h"

namespace vrc {
namespace {

constexpr int kMaxFilmSize = 65536;
constexpr int kMaxNesting = 8;

FilmDescription read_filter(const XmlElement& element, MitsubaContext& context) {
  Properties properties(element, context);
  FilmDescription film;
  const std::string_view type = element.get("type");
  if (type == "gaussian") {
    film.filter = PixelFilter::kGaussian;
    film.gaussian_stddev = properties.number("stddev").value_or(film.gaussian_stddev);
    if (!(film.gaussian_stddev > 0.0 && film.gaussian_stddev <= 16.0)) {
      fail(element, fmt::format("stddev {:g} should be above 0 and at most 16 pixels", film.gaussian_stddev));
    }
  } else if (type == "box") {
    const double radius = properties.number("radius").value_or(0.5);
    if (radius != 0.5) context.report.reject(element, "a box filter of another size than one pixel; use 0.5");
  } else {
    context.report.reject(element, "this filter is not supported; use box or gaussian", "box is used");
    return film;
  }
  properties.finish();
  return film;
}

int read_film_size(const XmlElement& element, Properties& properties, const char* name, int fallback) {
  const int size = properties.integer(name).value_or(fallback);
  if (size < 1 || size > kMaxFilmSize) {
    fail(element, fmt::format("{} {} should be 1 to {} pixels", name, size, kMaxFilmSize));
  }
  return size;
}

/// Mitsuba's film without a size has 768 x 576 pixels, and without a filter a Gaussian one.
void read_film(const XmlElement& element, MitsubaContext& context, SceneDescription& scene) {
  Properties properties(element, context);
  const std::string_view type = element.get("type");
  if (type != "hdrfilm" && type != "ldrfilm" && type != "mfilm") {
    context.report.reject(element, "this film is not supported; use hdrfilm", "read as hdrfilm");
  }
  const int width = read_film_size(element, properties, "width", 768);
  const int height = read_film_size(element, properties, "height", 576);
  scene.camera.resize(width, height);
  const std::vector<const XmlElement*> filters = properties.objects("rfilter");
  if (filters.size() > 1) fail(*filters[1], "a second filter; remove one");
  scene.film.filter = PixelFilter::kGaussian;
  if (!filters.empty()) scene.film = read_filter(*filters.front(), context);
  properties.ignore({"file_format", "pixel_format", "component_format", "attach_log", "banner", "gamma",
                     "exposure", "tonemap_method", "key", "burn", "variable", "digits", "high_quality_edges",
                     "sample_border", "compensate"});
  properties.finish();
}

/// "50mm" for a 36 x 24 mm frame, as the angle across its diagonal.
double fov_of_focal_length(const XmlElement& element, const std::string& text) {
  const std::string_view number = std::string_view(text).substr(0, text.find("mm"));
  double length = 0.0;
  const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), length);
  if (error != std::errc() || rest != number.data() + number.size() || !(length > 0.0)) {
    fail(element, fmt::format("focal_length '{}' should be millimetres above 0, such as 50mm", text));
  }
  return 2.0 * std::atan(std::hypot(36.0, 24.0) / (2.0 * length)) * 180.0 / kPi;
}

/// Tangent of half the horizontal field of view. A diagonal of 1 spans 1 / sqrt(1 + 1 / aspect^2) of
/// the width.
double read_tan_half_width(const XmlElement& element, Properties& properties, double aspect) {
  std::string axis = properties.string("fov_axis").value_or("x");
  std::optional<double> fov = properties.number("fov");
  const std::optional<std::string> focal_length = properties.string("focal_length");
  if (fov && focal_length) fail(element, "fov and focal_length exclude each other; remove one");
  if (!fov) {
    fov = fov_of_focal_length(element, focal_length.value_or("50mm"));
    axis = "diagonal";
  }
  if (!(*fov > 0.0 && *fov < 180.0)) fail(element, fmt::format("fov {:g} should be between 0 and 180", *fov));
  if (axis == "smaller") axis = aspect > 1.0 ? "y" : "x";
  if (axis == "larger") axis = aspect > 1.0 ? "x" : "y";
  const double tangent = std::tan(0.5 * *fov * kPi / 180.0);
  if (axis == "x") return tangent;
  if (axis == "y") return tangent * aspect;
  if (axis == "diagonal") return tangent / std::sqrt(1.0 + 1.0 / (aspect * aspect));
  fail(element, fmt::format("fov_axis '{}' is not known; use x, y, diagonal, smaller or larger", axis));
}

/// Mitsuba's camera looks along its local +z, with +y up and +x to the left of the image.
void place(Camera& camera, const Mat4& to_world) {
  camera.origin = to_world.topRightCorner<3, 1>();
  camera.forward = to_world.block<3, 1>(0, 2).normalized();
  const Vec3 up = to_world.block<3, 1>(0, 1);
  camera.up = (up - up.dot(camera.forward) * camera.forward).normalized();
  const double handedness = to_world.topLeftCorner<3, 3>().determinant() < 0.0 ? -1.0 : 1.0;
  camera.right = handedness * camera.forward.cross(camera.up);
}

int nested_max_depth(const XmlElement& element, MitsubaContext& context, int depth) {
  if (depth > kMaxNesting) fail(element, "integrators nested too deep; a <ref> may lead back to itself");
  Properties properties(element, context);
  const std::vector<const XmlElement*> nested = properties.objects("integrator");
  if (!nested.empty()) return nested_max_depth(*nested.front(), context, depth + 1);
  const int max_depth = properties.integer("max_depth").value_or(element.get("type") == "direct" ? 2 : -1);
  if (max_depth < -1) fail(element, fmt::format("max_depth {} should be -1 (unbounded) or more", max_depth));
  return max_depth;
}

}  // namespace

void read_sensor(const XmlElement& element, const SceneReadOptions& options, MitsubaContext& context,
                 SceneDescription& scene) {
  Properties properties(element, context);
  if (element.get("type") != "perspective") {
    context.report.reject(element, "this sensor is not supported; use perspective", "read as perspective");
  }
  const std::vector<const XmlElement*> films = properties.objects("film");
  if (films.size() > 1) fail(*films[1], "a second film; remove one");
  scene.camera.resize(768, 576);
  scene.film.filter = PixelFilter::kGaussian;
  if (!films.empty()) read_film(*films.front(), context, scene);
  scene.camera.resize(options.width.value_or(scene.camera.width),
                      options.height.value_or(scene.camera.height));

  for (const XmlElement* sampler : properties.objects("sampler")) {
    Properties own(*sampler, context);
    scene.samples_per_pixel = own.integer("sample_count").value_or(scene.samples_per_pixel);
    if (scene.samples_per_pixel < 1) fail(*sampler, "sample_count should be 1 or more");
  }
  const double aspect = static_cast<double>(scene.camera.width) / scene.camera.height;
  scene.camera.tan_half_width = read_tan_half_width(element, properties, aspect);
  place(scene.camera, properties.transform("to_world").value_or(Mat4::Identity()));
  properties.ignore({"near_clip", "far_clip", "focus_distance", "shutter_open", "shutter_close"});
  properties.finish();
}

int read_max_depth(const XmlElement& element, MitsubaContext& context) {
  return nested_max_depth(element, context, 0);
}

}  // namespace vrc
