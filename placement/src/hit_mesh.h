// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gather_rays.h"

namespace vrc {

/// What the rays of one gather met, by the cells of the Sobol grid that their directions were drawn from.
///
/// The storage belongs to the thread and serves one gather at a time.
class HitGrid {
 public:
  HitGrid(int columns_log2, int rows_log2);

  /// Stores a packet. `u1`, `u2` are the coordinates of its points in the Sobol grid.
  void store(F16 u1, F16 u2, const GatherPacket16& packet);

  enum Field {
    kDirectionX,  ///< Unit, world frame.
    kDirectionY,
    kDirectionZ,
    kInverseDistance,  ///< 0 without a hit. [1/length]
    kPlaneX,           ///< GatherPacket16::tangent_plane
    kPlaneY,
    kPlaneZ,
    kRadianceR,  ///< Towards the record.
    kRadianceG,
    kRadianceB,
    kSlope1,  ///< Gradient of the logarithm of its luminance as the record moves and the hit stays.
    kSlope2,
    kSquare1,  ///< GatherPacket16::u1
    kSquare2,
    kTriangle,  ///< Bits of GatherPacket16::triangle
    kFields
  };

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Index of a cell in `field`.
  [[nodiscard]] int index(int column, int row) const { return column * stride_ + row; }
  [[nodiscard]] int index_end() const { return columns_ * stride_; }
  [[nodiscard]] const float* field(Field f) const { return values_.data() + f * field_size_; }

 private:
  int columns_, rows_, stride_;
  std::size_t field_size_;
  std::vector<float>& values_;
};

/// The rays of one sampling strategy as the vertices of a triangle mesh on the sphere of directions.
///
/// The second coordinate of the sampling square is an azimuth, and a guide moves the first one of all points
/// alike: so a column of the Sobol grid is a loop of directions around the strategy's axis, between the
/// loops of its neighbours however far each row was moved. Loops are in the order of their azimuths, and so
/// are two neighbouring ones joined.
///
/// The storage belongs to the thread and serves one strategy at a time.
class HitMesh {
 public:
  HitMesh(const HitGrid& grid, const GatherStrategy& strategy);

  /// Vertices, as cells of the grid, of sixteen triangles that are counter-clockwise as seen from outside
  /// the sphere.
  using Triangles16 = std::array<I16, 3>;
  [[nodiscard]] std::size_t triangle_count() const { return storage_.corners[0].size(); }
  /// From `first` on; those beyond the last one repeat that.
  [[nodiscard]] Triangles16 triangles(std::size_t first) const;

  /// Neighbours of cells; -1 beyond the mesh. Those in other loops are the nearest in azimuth.
  enum Link { kNext, kPrevious, kInner, kOuter, kLinks };
  [[nodiscard]] I16 neighbours(Link link, I16 cells) const {
    return gather(storage_.links[link].data(), cells);
  }

 private:
  struct Storage {
    std::vector<int> cells;  // of all loops
    std::vector<std::size_t> loop_starts;
    std::array<std::vector<std::int32_t>, 3> corners;
    std::array<std::vector<std::int32_t>, kLinks> links;
  };
  static Storage& thread_storage();

  void make_loops(const HitGrid& grid, const GatherStrategy& strategy);
  void fill_first_loop();
  void join(std::size_t inner_loop);
  void add_triangle(int a, int b, int c);
  [[nodiscard]] std::span<const int> loop(std::size_t i) const;

  Storage& storage_;
  const float* azimuth_;
};

}  // namespace vrc
