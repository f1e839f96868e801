// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/record_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "geometry/ellipse_tessellation.h"
#include "line_painter.h"
#include "placement/surface_reach.h"

namespace vrc {
namespace {

constexpr double kPieceLength = 4.0;     // [pixels] A piece is seen whole or not at all.
constexpr double kNearest = 1e-4;        // of the scene's radius, before the camera
constexpr double kFullLineRadius = 4.0;  // [pixels] Smaller ellipses have thinner lines,
constexpr double kThinnest = 0.35;       // down to this share of the full width.
constexpr float kTolerance = 1e-3f;      // of the distance, by which an occluder must be nearer

/// A straight piece on the film, and the point that must be seen for it to be drawn.
struct Stroke {
  Vec2f a, b;
  Vec3f seen;
  bool is_center;
};

class Projection {
 public:
  explicit Projection(const Scene& scene) : camera_(scene.camera()), nearest_(kNearest * scene.radius()) {}

  [[nodiscard]] double nearest() const { return nearest_; }
  [[nodiscard]] double depth(const Vec3& p) const { return (p - camera_.origin).dot(camera_.forward); }
  /// Of a point before the camera.
  [[nodiscard]] Vec2 operator()(const Vec3& p) const {
    const Vec3 d = (p - camera_.origin) / (depth(p) * camera_.pixel_size());
    return {0.5 * camera_.width + d.dot(camera_.right), 0.5 * camera_.height - d.dot(camera_.up)};
  }
  [[nodiscard]] bool misses_film(const Vec2& a, const Vec2& b) const {
    const double margin = 2.0;
    return std::max(a.x(), b.x()) < -margin || std::min(a.x(), b.x()) > camera_.width + margin ||
           std::max(a.y(), b.y()) < -margin || std::min(a.y(), b.y()) > camera_.height + margin;
  }

 private:
  const Camera& camera_;
  double nearest_;
};

/// Part of the segment before the camera, in pieces that are short on the film.
void append_pieces(const Projection& project, Vec3 begin, Vec3 end, std::vector<Stroke>& strokes) {
  double z0 = project.depth(begin), z1 = project.depth(end);
  if (z0 < project.nearest() && z1 < project.nearest()) return;
  if (z0 < project.nearest()) begin += (project.nearest() - z0) / (z1 - z0) * (end - begin);
  if (z1 < project.nearest()) end += (project.nearest() - z1) / (z0 - z1) * (begin - end);
  const Vec2 a = project(begin), b = project(end);
  if (project.misses_film(a, b)) return;
  z0 = project.depth(begin);
  z1 = project.depth(end);
  const auto count = static_cast<int>(std::clamp(std::ceil((b - a).norm() / kPieceLength), 1.0, 1e5));
  for (int i = 0; i < count; ++i) {
    const double t0 = static_cast<double>(i) / count, t1 = static_cast<double>(i + 1) / count;
    const Vec2 p = a + t0 * (b - a), q = a + t1 * (b - a);
    if (project.misses_film(p, q)) continue;
    // Where the middle of the piece on the film is on the segment in space.
    const double t = 0.5 * (t0 + t1);
    const double s = t * z0 / (t * z0 + (1.0 - t) * z1);
    strokes.push_back({p.cast<float>(), q.cast<float>(), (begin + s * (end - begin)).cast<float>(), false});
  }
}

/// The strokes that a ray from the camera reaches.
void keep_visible(const Scene& scene, std::vector<Stroke>& strokes) {
  const V3x16 origin = splat3(scene.camera().origin);
  std::size_t kept = 0;
  for (std::size_t first = 0; first < strokes.size(); first += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, strokes.size() - first);
    Ray16 ray{origin, splat3(Vec3(scene.camera().forward)), splat(1.0f - kTolerance)};
    for (std::size_t lane = 0; lane < count; ++lane) {
      const Vec3f d = strokes[first + lane].seen - scene.camera().origin.cast<float>();
      ray.direction.x[lane] = d.x();
      ray.direction.y[lane] = d.y();
      ray.direction.z[lane] = d.z();
    }
    const I16 hidden =
        scene.tracer().occluded(lane_index() < static_cast<int>(count), ray, RayTracer::Coherence::kCoherent);
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (hidden[lane] == 0) strokes[kept++] = strokes[first + lane];
    }
  }
  strokes.resize(kept);
}

/// The smaller radius of the drawn ellipse, seen face on. [pixels]
double drawn_radius(const RadianceRecord& record, double scale) {
  return scale * std::min(record.region.radius1, record.region.radius2) / record.site.pixel_length;
}

/// So many that the polygon is nowhere off the ellipse by more than a tenth of a pixel.
int segments_of(const RadianceRecord& record, double scale) {
  constexpr double kError = 0.1;
  const ValidRegion& region = record.region;
  const double radius = scale * std::max(region.radius1, region.radius2) / record.site.pixel_length;
  return static_cast<int>(std::clamp(std::ceil(kPi / std::sqrt(2.0 * kError / radius)), 12.0, 256.0));
}

/// What is seen of a record's ellipse's rim and its centre.
std::vector<Stroke> strokes_of(const Scene& scene, const RadianceRecord& record, double scale) {
  const Projection project(scene);
  const SurfacePoint& point = record.site.point;
  const SurfaceMesh& mesh = scene.surface_mesh(scene.surface_of(point.triangle));
  std::vector<Stroke> strokes;
  append_pieces(project, point.position, point.position, strokes);
  if (!strokes.empty()) strokes.front().is_center = true;
  EllipseTessellationOptions options;
  options.segments = segments_of(record, scale);
  const SurfaceEllipse ellipse = surface_ellipse(scene, point, record.region, scale);
  for (const OutlineSegment& s : ellipse_outline(mesh, ellipse, options)) {
    append_pieces(project, s.begin, s.end, strokes);
  }
  keep_visible(scene, strokes);
  return strokes;
}

/// R, G, B in [0, 1]; NaN becomes 0.
Image clamped(const Image& picture) {
  std::array<std::size_t, 3> source{0, 1, 2};
  constexpr std::array<const char*, 3> kNames{"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto at = std::ranges::find(picture.channels, kNames[c]);
    VRC_CHECK(at != picture.channels.end(), "a picture without the channel {}", kNames[c]);
    source[c] = static_cast<std::size_t>(at - picture.channels.begin());
  }
  Image image(picture.width, picture.height, {"R", "G", "B"});
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = picture.pixel(x, y)[source[c]];
        image.pixel(x, y)[c] = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
      }
    }
  }
  return image;
}

void blend(Image& image, const LinePainter& layer, const Rgb& color) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float share = layer.coverage(x, y);
      for (int c = 0; c < 3; ++c) {
        float& value = image.pixel(x, y)[c];
        value += share * (color[c] - value);
      }
    }
  }
}

}  // namespace

Image draw_record_overlay(const Image& picture, const RadianceCache& cache,
                          const RecordOverlayOptions& options) {
  const Scene& scene = cache.charts().scene();
  VRC_CHECK(picture.width == scene.camera().width && picture.height == scene.camera().height,
            "a picture of {}x{} pixels", picture.width, picture.height);
  const auto records = cache.records();
  std::vector<std::vector<Stroke>> strokes(records.size());
  parallel_for(records.size(),
               [&](std::size_t i) { strokes[i] = strokes_of(scene, records[i], options.scale); });
  LinePainter taylor(picture.width, picture.height), harmonics = taylor;
  for (std::size_t i = 0; i < records.size(); ++i) {
    LinePainter& layer = records[i].uses_harmonics() ? harmonics : taylor;
    // Small ellipses, which crowd, get thinner lines and smaller dots.
    const double share =
        std::clamp(drawn_radius(records[i], options.scale) / kFullLineRadius, kThinnest, 1.0);
    for (const Stroke& s : strokes[i]) {
      const double radius = share * (s.is_center ? options.dot_radius : 0.5 * options.line_width);
      layer.stroke(s.a.cast<double>(), s.b.cast<double>(), radius);
    }
  }
  Image image = clamped(picture);
  blend(image, taylor, options.taylor_color);
  blend(image, harmonics, options.harmonics_color);
  return image;
}

}  // namespace vrc
