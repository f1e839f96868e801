// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "transport/brdf_harmonics.h"
#include "transport/scene.h"

namespace vrc {

/// The weights by which the BRDFs at sixteen points reflect harmonics of incident radiance towards the
/// viewer; computed when they are first asked for. Lanes whose normals and directions differ by less
/// than the harmonics resolve share those of their mean.
class PacketResponse {
 public:
  struct Group {
    I16 lanes{};
    Eigen::MatrixXf weights;  ///< BrdfHarmonics::response.
  };

  /// `to_viewer` are unit. All must outlive it; `brdfs` may be null if nobody asks.
  PacketResponse(const BrdfHarmonicsSet* brdfs, const SurfacePoint16& points, const V3x16& to_viewer)
      : brdfs_(brdfs), points_(points), to_viewer_(to_viewer) {}

  /// Together all lanes that scatter. Valid until another packet's are asked for in this thread.
  [[nodiscard]] std::span<const Group> groups();

 private:
  void compute();

  const BrdfHarmonicsSet* brdfs_;
  const SurfacePoint16& points_;
  const V3x16& to_viewer_;
  std::span<const Group> groups_;
};

}  // namespace vrc
