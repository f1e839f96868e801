// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/frame.h"
#include "sh/basis.h"
#include "sh/frame_rotator.h"
#include "transport/bsdf.h"

namespace vrc {

/// A lobe's f cos_i as a function of the incident direction, in real spherical harmonics, for every
/// outgoing direction. Tabulated over the outgoing polar angle in the frame of the lobe: its normal is the
/// mirrored outgoing direction (the surface normal for Lambert), its tangent lies in the plane of
/// incidence. There the coefficients hardly depend on the angle, so that a coarse table is enough. Made
/// by sampling: any lobe with `sample`, `pdf`, `shape` and `tint` will do.
class LobeHarmonics {
 public:
  LobeHarmonics(const Lobe& lobe, const sh::Basis& basis);

  /// Columns of `response`: 1 or, when Fresnel's term colours the lobe, 3.
  [[nodiscard]] int channels() const { return channels_; }
  /// With reflectance 1.
  [[nodiscard]] const Lobe& lobe() const { return lobe_; }

  /// Coefficients, in the lobe's frame, of f cos_i for an outgoing direction with the cosine `cos_o` in
  /// [0, 1] to the normal, without the lobe's reflectance. Resizes `result`.
  void response(double cos_o, Eigen::MatrixXf& result) const;
  /// The frame for a normal and an outgoing direction on its side, both unit.
  [[nodiscard]] Frame frame(const Vec3& normal, const Vec3& outgoing) const;

 private:
  Lobe lobe_;
  int channels_;
  std::vector<Eigen::MatrixXf> table_;  ///< Over equal steps of the polar angle.
};

/// The lobes of a BRDF in spherical harmonics, and its matrix M: outgoing radiance
/// L(w_o) = sum_j w_j Lambda_j for the coefficients Lambda of incident radiance, with the weights w either
/// exact in w_o (`response`) or from the harmonics of w_o, w = M^T Y(w_o) [Zhao 4.2].
class BrdfHarmonics {
 public:
  struct Part {
    Rgb reflectance;
    std::shared_ptr<const LobeHarmonics> lobe;
  };
  /// `rotator` must outlive it; its order is that of the parts.
  BrdfHarmonics(std::vector<Part> parts, const sh::FrameRotator& rotator)
      : parts_(std::move(parts)), rotator_(&rotator) {}

  [[nodiscard]] int order() const { return rotator_->order(); }
  [[nodiscard]] int count() const { return sh::coefficient_count(order()); }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  /// Turns functions of its order.
  [[nodiscard]] const sh::FrameRotator& rotator() const { return *rotator_; }

  /// Weights per channel for radiance in world axes: coefficient_count(order) x 3. `normal` and
  /// `outgoing` are unit; 0 when the outgoing direction is below the surface.
  void response(const Vec3& normal, const Vec3& outgoing, Eigen::Ref<Eigen::MatrixXf> weights) const;

  /// M of one channel in the surface's frame: the outgoing coefficients are M times the incident ones
  /// [PharrHumphreys2010]. BRDFs are isotropic, so it only couples harmonics of the same m; made on first
  /// use.
  [[nodiscard]] const Eigen::MatrixXf& matrix(int channel) const;

 private:
  void make_matrices() const;

  std::vector<Part> parts_;
  const sh::FrameRotator* rotator_;
  mutable std::once_flag matrices_made_;
  mutable Eigen::MatrixXf matrices_[3];
};

/// The BRDFs of a scene in spherical harmonics, each made when it is first asked for; equal lobes of one
/// order are made once. Thread-safe; what it returns lives as long as it does.
class BrdfHarmonicsSet {
 public:
  /// One order for each BRDF, in [0, sh::kMaxFrameOrder]. `bsdfs` must outlive the set.
  BrdfHarmonicsSet(const std::vector<Bsdf>& bsdfs, std::span<const int> orders);
  /// The same order for all.
  BrdfHarmonicsSet(const std::vector<Bsdf>& bsdfs, int order)
      : BrdfHarmonicsSet(bsdfs, std::vector<int>(bsdfs.size(), order)) {}

  [[nodiscard]] const BrdfHarmonics& of(std::size_t material) const;

 private:
  struct Entry {
    std::once_flag made;
    std::unique_ptr<const BrdfHarmonics> brdf;
  };
  /// What BRDFs of one order share.
  struct Tools {
    sh::Basis basis;
    sh::FrameRotator rotator;
    mutable std::mutex making;
    mutable std::vector<std::shared_ptr<const LobeHarmonics>> lobes;

    explicit Tools(int order) : basis(order), rotator(order) {}
  };
  [[nodiscard]] static std::unique_ptr<const BrdfHarmonics> make(const Bsdf& bsdf, const Tools& tools);

  const std::vector<Bsdf>& bsdfs_;
  std::map<int, Tools> tools_;          ///< By order.
  std::vector<const Tools*> tools_of_;  ///< Per material.
  mutable std::vector<Entry> entries_;
};

}  // namespace vrc
