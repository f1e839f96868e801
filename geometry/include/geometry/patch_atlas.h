// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/frame.h"
#include "core/types.h"
#include "geometry/surface_mesh.h"

namespace vrc {

using Mat32 = Eigen::Matrix<double, 3, 2>;

/// How a chart was flattened, in the order in which the methods are tried.
enum class ChartMethod : std::uint8_t {
  kConformal,     ///< Least-squares conformal map [Levy2002].
  kOrthographic,  ///< Projection onto the chart's mean plane; exact where the chart is plane.
  kSingleFace,    ///< The chart is one face, laid down as it is.
};
inline constexpr std::size_t kChartMethods = 3;

struct PatchAtlasOptions {
  double cone_angle = 50.0;         ///< Between a chart's axis and the normals of its faces. [degrees]
  double merge_cone_angle = 65.0;   ///< The same after tiny charts were merged into it. [degrees]
  std::size_t tiny_faces = 8;       ///< Charts with fewer faces are merged into a neighbour,
  double tiny_area_share = 0.01;    ///< and so are those below this share of their region's area.
  std::size_t max_faces = 50000;    ///< Growth of a bent chart stops here, which bounds the solves.
  double max_stretch = 3.0;         ///< Ratio of the singular values of a face's map; more is refused.
  double max_area_distortion = 16;  ///< Ratio of areas, either way; more is refused.
  /// Above so many faces the projection is tried first and taken if its stretch is at most
  /// `direct_stretch`.
  std::size_t direct_faces = 20000;
  double direct_stretch = 1.15;
};

/// One chart: connected faces of one smooth region with a map to the plane.
struct Patch {
  ChartMethod method = ChartMethod::kSingleFace;
  /// Of the mean plane: the mean normal by area; the tangent and bitangent point along u and v.
  Frame frame;
  double area = 0.0;                  ///< [world units squared]; the same in (u, v).
  Vec2 uv_size = Vec2::Zero();        ///< The chart fills [0, uv_size.x] x [0, uv_size.y]. [world units]
  Vec2 layout_offset = Vec2::Zero();  ///< Of the chart's (0, 0) in the packed layout.
};

/// Figures over all faces. Of the singular values s1 >= s2 of a face's map from the surface to (u, v),
/// stretch is s1 / s2 (1: no angle changes) and area distortion max(s1 s2, 1 / (s1 s2)).
struct AtlasQuality {
  std::size_t flipped_faces = 0;  ///< Not counter-clockwise in (u, v); always 0.
  double max_stretch = 1.0;
  double mean_stretch = 1.0;  ///< By area.
  double max_area_distortion = 1.0;
  double mean_area_distortion = 1.0;  ///< By area.
  std::array<std::size_t, kChartMethods> patches_by_method{};
  std::array<std::size_t, kChartMethods> faces_by_method{};
};

/// Charts that together hold every face of a mesh once. The faces of a chart are connected over smooth
/// edges, so no chart reaches across a crease except around its end.
///
/// (u, v) are world lengths, local to each patch, continuous over the edges inside it (also those of a
/// crease that ends in it), and counter-clockwise like the faces. No two faces of a patch overlap in
/// (u, v).
///
/// Refers to the mesh, which must outlive it. Immutable.
class PatchAtlas {
 public:
  [[nodiscard]] const SurfaceMesh& mesh() const { return *mesh_; }
  [[nodiscard]] std::size_t patch_count() const { return patches_.size(); }
  [[nodiscard]] const Patch& patch(std::size_t patch) const { return patches_[patch]; }
  /// Patches are numbered from 0 by their smallest faces.
  [[nodiscard]] std::uint32_t patch_of(std::size_t face) const { return face_patch_[face]; }
  /// In rising order.
  [[nodiscard]] std::span<const std::uint32_t> faces(std::size_t patch) const {
    return std::span(faces_).subspan(face_begin_[patch], face_begin_[patch + 1] - face_begin_[patch]);
  }
  /// Patches across smooth edges, in rising order.
  [[nodiscard]] std::span<const std::uint32_t> neighbours(std::size_t patch) const {
    return std::span(neighbours_)
        .subspan(neighbour_begin_[patch], neighbour_begin_[patch + 1] - neighbour_begin_[patch]);
  }

  [[nodiscard]] const Vec2& uv(std::size_t face, int k) const {
    return uv_[3 * face + static_cast<std::size_t>(k)];
  }
  [[nodiscard]] Vec2 uv(std::size_t face, const Vec3& barycentric) const {
    return barycentric[0] * uv(face, 0) + barycentric[1] * uv(face, 1) + barycentric[2] * uv(face, 2);
  }
  /// dx / d(u, v) of a face in world space: the columns are tangent to the face.
  [[nodiscard]] Mat32 jacobian(std::size_t face) const;
  /// Of the face's map from the surface to (u, v), largest first.
  [[nodiscard]] Vec2 singular_values(std::size_t face) const;

  /// The patch's frame carried to a unit normal by the smallest rotation.
  [[nodiscard]] Frame frame_at(std::size_t patch, const Vec3& normal) const;
  /// Parallel transport: takes tangent coordinates in the frame of `from` to those in the frame of
  /// `to` by the smallest rotation between their normals. A rotation matrix; that of the way back is
  /// its transpose.
  [[nodiscard]] Mat2 transport(std::size_t from, std::size_t to) const;

  /// Where the charts lie side by side in one picture [0, size.x] x [0, size.y]. [world units]
  [[nodiscard]] const Vec2& layout_size() const { return layout_size_; }
  [[nodiscard]] Vec2 layout_uv(std::size_t face, int k) const {
    return uv(face, k) + patches_[face_patch_[face]].layout_offset;
  }
  [[nodiscard]] const AtlasQuality& quality() const { return quality_; }

 private:
  friend PatchAtlas build_patch_atlas(const SurfaceMesh& mesh, const PatchAtlasOptions& options);
  PatchAtlas() = default;

  const SurfaceMesh* mesh_ = nullptr;
  std::vector<Patch> patches_;
  std::vector<std::uint32_t> face_patch_;
  std::vector<std::uint32_t> face_begin_, faces_;
  std::vector<std::uint32_t> neighbour_begin_, neighbours_;
  std::vector<Vec2> uv_;  ///< Per corner.
  Vec2 layout_size_ = Vec2::Zero();
  AtlasQuality quality_;
};

/// Grows charts by a normal cone inside the smooth regions, merges tiny ones, and flattens each:
/// conformally, else by projection, else cut into smaller ones, down to single faces. Every method
/// is checked for flips, overlaps and distortion, so every mesh gets a valid atlas. The same at any
/// thread count.
[[nodiscard]] PatchAtlas build_patch_atlas(const SurfaceMesh& mesh, const PatchAtlasOptions& options = {});

}  // namespace vrc
