// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/record_factory.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/hash.h"
#include "placement/irradiance.h"

namespace vrc {
namespace {

constexpr int kLeastOrder = 8, kMostOrder = 24;
// CPU time of a record of spherical harmonics over that of a Taylor record: the radiance that its class is
// judged by, and the sums over the rays (bench/kernels).
constexpr double kCostOfOrder = 0.0145;  // times order^2
constexpr double kNarrowRadius = 1.7;    // of curvature, in pixels, at which no Taylor record fits an edge
// Accepted errors up to which narrow edges get harmonics where pixels are not gathered again: in coarser
// pictures a record there covers more than it knows. Less where the order leaves a part of the lobe out,
// which takes 3 sqrt(exponent).
constexpr double kNarrowUpTo = 0.2, kNarrowUpToTruncated = 0.05;
constexpr double kResolvedOrder = 3.0;

/// The most that the normal turns over a pixel's length. [rad]
double turn_over_pixel(const RecordSite& site) {
  const Vec2 principal = site.point.shape_operator.selfadjointView<Eigen::Lower>().eigenvalues();
  return site.pixel_length * principal.cwiseAbs().maxCoeff();
}

/// Whether the surface is an edge so narrow that Taylor records, which are no smaller than a pixel, do not
/// fit it, however many there are.
bool is_narrow(const RecordSite& site) { return kNarrowRadius * turn_over_pixel(site) > 1.0; }

/// How many Taylor records, whose normals may turn by `theta_max`, one of spherical harmonics stands for
/// within the record's ellipse.
double records_replaced(const RadianceRecord& record, double theta_max) {
  const Mat2 turn = record.site.point.shape_operator * half_axes(record.region, record.site.frame);
  const auto along = [&](int axis) {
    return std::clamp(turn.col(axis).norm(), theta_max, std::max(theta_max, kHarmonicsTurn)) / theta_max;
  };
  return along(0) * along(1);
}

/// |H| of a symmetric matrix: that with the absolute eigenvalues.
Mat2 absolute(const Mat2& h) {
  Eigen::SelfAdjointEigenSolver<Mat2> solver;
  solver.computeDirect(h);
  return solver.eigenvectors() * solver.eigenvalues().cwiseAbs().asDiagonal() *
         solver.eigenvectors().transpose();
}

/// Variance of what the weights make of harmonics, taken as if they were those of luminance.
double reflected_variance(const HarmonicsGatherer::NoiseSums& noise, const Eigen::MatrixXf& weights) {
  const Eigen::VectorXf mean =
      weights * Eigen::Vector3d(kLuminance[0], kLuminance[1], kLuminance[2]).cast<float>();
  return static_cast<double>((noise.transpose() * mean).squaredNorm()) / 2.0;
}

/// L1 norm of coefficients and the sum of their |H| [Zhao eq. 6]. Rows are coefficients, columns the
/// entries of a jet.
Jet2 sum_over_coefficients(const Eigen::MatrixXd& jets) {
  Jet2 sum;
  for (Eigen::Index j = 0; j < jets.rows(); ++j) {
    Mat2 h;
    h << jets(j, 3), jets(j, 4), jets(j, 4), jets(j, 5);
    sum.value += std::abs(jets(j, 0));
    sum.hessian += absolute(h);
  }
  return sum;
}

/// Incident radiance with what the weights reflect of it.
std::shared_ptr<RecordHarmonics> with_radiance(IncidentHarmonics incident, const Eigen::MatrixXf& weights) {
  auto result = std::make_shared<RecordHarmonics>();
  result->incident = std::move(incident);
  result->radiance = outgoing_radiance(result->incident, weights);
  result->luminance = luminance(result->radiance);
  return result;
}

/// Entries of channel c: coefficients x entries.
Eigen::MatrixXf channel(const IncidentHarmonics::Coefficients& incident, int c) {
  constexpr int kEntries = IncidentHarmonics::kEntries;
  return incident.middleRows(kEntries * c, kEntries).transpose();
}

/// Towards one camera the lobe matters most; for all of them light that arrives steeply does.
GatherDirections directions_for(const CacheOptions& options) {
  switch (options.harmonics_rays) {
    case HarmonicsRays::kUniform:
      return GatherDirections::kUniform;
    case HarmonicsRays::kCosine:
      return GatherDirections::kCosine;
    case HarmonicsRays::kBrdf:
      return GatherDirections::kMixture;
    case HarmonicsRays::kAuto:
      break;
  }
  return options.strategy == Strategy::kViewDependent ? GatherDirections::kMixture
                                                      : GatherDirections::kCosine;
}

/// The estimate of the rays of two independent ones together.
RadianceEstimate pooled(const RadianceEstimate& a, double rays_of_a, const RadianceEstimate& b,
                        double rays_of_b) {
  const double sa = rays_of_a / (rays_of_a + rays_of_b), sb = 1.0 - sa;
  RadianceEstimate sum;
  for (std::size_t c = 0; c < 3; ++c) {
    sum.radiance[c] = sa * a.radiance[c] + sb * b.radiance[c];
    sum.tilt[c] = sa * a.tilt[c] + sb * b.tilt[c];
  }
  sum.luminance = sa * a.luminance + sb * b.luminance;
  sum.variance = sa * sa * a.variance + sb * sb * b.variance;
  sum.hits = a.hits.nearest <= b.hits.nearest ? a.hits : b.hits;
  sum.hits.mean_inverse = sa * a.hits.mean_inverse + sb * b.hits.mean_inverse;
  return sum;
}

/// Luminance of incident radiance in all directions.
Jet2 all_incident(const IncidentHarmonics::Coefficients& incident) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(incident.cols(), IncidentHarmonics::kEntries);
  for (int c = 0; c < 3; ++c) sum += kLuminance[c] * channel(incident, c).cast<double>();
  return sum_over_coefficients(sum);
}

/// Luminance of outgoing radiance in all directions, the normal staying as it is.
Jet2 all_outgoing(const IncidentHarmonics::Coefficients& incident, const BrdfHarmonics& brdf,
                  const Frame& frame) {
  const Frame to_surface = sh::transposed(frame);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(incident.cols(), IncidentHarmonics::kEntries);
  Eigen::MatrixXf local(incident.cols(), IncidentHarmonics::kEntries);
  for (int c = 0; c < 3; ++c) {
    brdf.rotator().rotate(to_surface, channel(incident, c), local);
    sum += kLuminance[c] * (brdf.matrix(c) * local).cast<double>();
  }
  return sum_over_coefficients(sum);
}

}  // namespace

int harmonics_order_for(const Bsdf& bsdf) {
  const double wanted = std::ceil(3.5 * std::sqrt(static_cast<double>(bsdf.sharpness())));
  return std::clamp(static_cast<int>(std::min(wanted, 1e3)), kLeastOrder, kMostOrder);
}

int harmonics_order_for(const std::vector<Bsdf>& bsdfs) {
  int order = kLeastOrder;
  for (const Bsdf& bsdf : bsdfs) order = std::max(order, harmonics_order_for(bsdf));
  return order;
}

RecordFactory::RecordFactory(const SceneCharts& charts, const CacheOptions& options,
                             std::shared_ptr<const BrdfHarmonicsSet> brdfs)
    : charts_(charts), options_(options), brdfs_(std::move(brdfs)) {
  if (options.representation == Representation::kAnalytic && options.strategy == Strategy::kViewDependent)
    return;
  const std::vector<Bsdf>& bsdfs = charts.scene().bsdfs();
  if (options.representation == Representation::kIrradiance) {
    if (std::ranges::any_of(bsdfs, [](const Bsdf& b) { return b.sharpness() > 0.0f; }))
      throw InputError("irradiance caching is for diffuse surfaces, and this scene has glossy ones");
    if (!brdfs_) brdfs_ = std::make_shared<const BrdfHarmonicsSet>(bsdfs, 1);
    return;
  }
  std::map<int, std::shared_ptr<const HarmonicsGatherer>> made;
  std::vector<int> orders;
  for (const Bsdf& bsdf : bsdfs) {
    const int order = options.harmonics_order > 0 ? options.harmonics_order : harmonics_order_for(bsdf);
    std::shared_ptr<const HarmonicsGatherer>& gatherer = made[order];
    if (!gatherer) gatherer = std::make_shared<const HarmonicsGatherer>(order);
    gatherers_.push_back(gatherer);
    orders.push_back(order);
  }
  if (!brdfs_) brdfs_ = std::make_shared<const BrdfHarmonicsSet>(bsdfs, orders);
}

RadianceRecord RecordFactory::make(const RecordSite& site, const GatherOptions& gather, const NoiseGoal& goal,
                                   RayCounts& counts, const GuideField& guides) const {
  const Scene& scene = charts_.scene();
  std::shared_ptr<const RecordHarmonics> harmonics;
  std::shared_ptr<const KeptHistogram> found;
  const auto options_for = [&](int log2_rays) {
    GatherOptions options = gather;
    options.log2_rays = log2_rays;
    return options;
  };
  const Gather gather_radiance_at = [&](const RecordSite& s, int log2_rays) {
    harmonics.reset();  // of a site that the record was moved from
    GatherOptions options = options_for(log2_rays);
    if (!options_.guided) return gather_radiance(scene, s, options, counts);
    const std::unique_ptr<const GuideWarp> warp = guides.warp_at(s, found.get());
    // Rays that guide others must not be among them.
    if (found != nullptr) options.seed = hash(options.seed, 0x6d1du);
    GuideHistogram own;
    RadianceEstimate estimate = gather_radiance(scene, s, options, counts, {warp.get(), &own});
    found = std::make_shared<const KeptHistogram>(own);
    return estimate;
  };
  const Gather gather_harmonics_at = [&](const RecordSite& s, int log2_rays) {
    RadianceEstimate estimate;
    found.reset();
    harmonics = gather_harmonics(s, options_for(log2_rays), counts, estimate.hits);
    estimate.radiance = harmonics->radiance;
    estimate.luminance = harmonics->luminance;
    return estimate;
  };
  const bool only_harmonics = holds_only_harmonics();
  const Gather gather_at = [&](const RecordSite& s, int log2_rays) {
    return (only_harmonics || surely_needs_harmonics(s) ? gather_harmonics_at : gather_radiance_at)(
        s, log2_rays);
  };
  RadianceRecord record = make_record(scene, site, gather_at, gather.log2_rays, goal);
  if (only_harmonics) {
    record.harmonics_reason = HarmonicsReason::kAlways;
  } else if (options_.strategy != Strategy::kViewDependent) {
    HitDistances hits;
    harmonics = gather_harmonics(record.site, gather, counts, hits);
    if (options_.representation == Representation::kAnalytic) {
      auto radii_only = std::make_shared<RecordHarmonics>(*harmonics);
      radii_only->incident = {};
      harmonics = std::move(radii_only);
    }
  }
  record.harmonics = std::move(harmonics);
  record.found = std::move(found);
  return record;
}

void RecordFactory::add_rays(RadianceRecord& record, const GatherOptions& gather, int log2_rays,
                             bool keep_own, RayCounts& counts, const GuideField& guides) const {
  const std::uint64_t rays = std::uint64_t{1} << log2_rays;
  const std::uint64_t own_rays = keep_own ? record.rays : 0;
  if (options_.representation == Representation::kHybrid) record.harmonics.reset();
  record.rays = own_rays + rays;
  if (surely_needs_harmonics(record.site)) return;
  GatherOptions options = gather;
  options.log2_rays = log2_rays;
  options.seed = hash(gather.seed, 0xadd5u, own_rays);
  RadianceEstimate more;
  if (options_.guided && record.found) {
    const std::unique_ptr<const GuideWarp> warp = guides.warp_at(record.site, record.found.get());
    GuideHistogram own;
    more = gather_radiance(charts_.scene(), record.site, options, counts, {warp.get(), &own});
    record.found = std::make_shared<const KeptHistogram>(own);
  } else {
    more = gather_radiance(charts_.scene(), record.site, options, counts);
  }
  record.estimate =
      keep_own ? pooled(record.estimate, static_cast<double>(own_rays), more, static_cast<double>(rays))
               : more;
}

std::shared_ptr<const RecordHarmonics> RecordFactory::gather_harmonics(const RecordSite& site,
                                                                       const GatherOptions& gather,
                                                                       RayCounts& counts,
                                                                       HitDistances& hits) const {
  GatherOptions options = gather;
  if (options_.representation == Representation::kIrradiance) {
    const IrradianceEstimate irradiance =
        gather_irradiance(charts_.scene(), site, options, options_.irradiance_derivatives, counts);
    hits = irradiance.hits;
    return with_radiance(as_harmonics(irradiance, site.point.normal), weights_at(site));
  }
  options.directions = directions_for(options_);
  // As many as guided rays suffice for are too few, and guided by the lobe they lose what other normals see.
  if (options_.representation == Representation::kHybrid && options_.guided && options_.gather_rays == 0)
    options.log2_rays = std::min(options.log2_rays + 1, kMostLog2Rays);
  HarmonicsGatherer::NoiseSums noise;
  const HarmonicsGatherer& gatherer = *gatherers_[static_cast<std::size_t>(site.point.material)];
  const Eigen::MatrixXf weights = weights_at(site);
  const auto result =
      with_radiance(gatherer.gather(charts_.scene(), site, options, counts, hits, &noise), weights);
  result->variance = reflected_variance(noise, weights);
  if (options_.strategy == Strategy::kViewIndependent)
    result->all_directions = all_incident(result->incident.coefficients());
  if (options_.strategy == Strategy::kViewIndependentOutgoing) {
    const BrdfHarmonics& brdf = brdfs_->of(static_cast<std::size_t>(site.point.material));
    result->all_directions = all_outgoing(result->incident.coefficients(), brdf, site.frame);
  }
  return result;
}

Eigen::MatrixXf RecordFactory::weights_at(const RecordSite& site) const {
  const BrdfHarmonics& brdf = brdfs_->of(static_cast<std::size_t>(site.point.material));
  Eigen::MatrixXf weights(brdf.count(), 3);
  brdf.response(site.point.normal, site.to_camera.normalized(), weights);
  return weights;
}

bool RecordFactory::resolves_lobes_at(const RecordSite& site) const {
  const auto material = static_cast<std::size_t>(site.point.material);
  const double sharpness = charts_.scene().bsdfs()[material].sharpness();
  return gatherers_[material]->order() >= kResolvedOrder * std::sqrt(sharpness);
}

bool RecordFactory::is_narrow_edge(const RecordSite& site) const {
  // Hard pixels cost less there and bring as much.
  const bool serves = options_.records > 0 ||
                      (!options_.hard_pixels &&
                       options_.error <= (resolves_lobes_at(site) ? kNarrowUpTo : kNarrowUpToTruncated));
  return serves && is_narrow(site);
}

bool RecordFactory::surely_needs_harmonics(const RecordSite& site) const {
  return options_.representation == Representation::kHybrid &&
         options_.strategy == Strategy::kViewDependent && turn_over_pixel(site) > options_.turning_angle() &&
         (options_.harmonics_rule == HarmonicsRule::kPaper || is_narrow_edge(site));
}

HarmonicsReason RecordFactory::reason_for(const RadianceRecord& record) const {
  if (options_.harmonics_rule == HarmonicsRule::kPaper)
    return record.curvature.needs_sh() ? HarmonicsReason::kTurns : HarmonicsReason::kNone;
  if (is_narrow_edge(record.site) && record.curvature.needs_sh()) return HarmonicsReason::kNarrow;
  // Where a number of records is wanted, theirs is the cost. Else it is CPU time, and a lobe that the order
  // cuts short loses more than a record saves.
  if (options_.records == 0 && !resolves_lobes_at(record.site)) return HarmonicsReason::kNone;
  const int order = gatherers_[static_cast<std::size_t>(record.site.point.material)]->order();
  const double cost = options_.records > 0 ? 1.0 : 2.0 + kCostOfOrder * order * order;
  return records_replaced(record, options_.turning_angle()) > cost ? HarmonicsReason::kReplacesMany
                                                                   : HarmonicsReason::kNone;
}

void RecordFactory::shape(RadianceRecord& record, const RegionRule& rule, const GatherOptions& gather,
                          RayCounts& counts) const {
  if (options_.representation == Representation::kHybrid) record.harmonics_reason = HarmonicsReason::kNone;
  const Bsdf& bsdf = charts_.scene().bsdfs()[static_cast<std::size_t>(record.site.point.material)];
  const auto sharpness = static_cast<double>(bsdf.weighted_sharpness());
  shape_record(record, rule, sharpness);
  if (options_.representation != Representation::kHybrid) return;
  // By the ellipse that the record would have with Taylor polynomials. The class takes a walk over the
  // surface: sites where it decides nothing get theirs once, when all records are made.
  const auto classify = [&] { record.curvature = classify_site(charts_, record, options_.turning_angle()); };
  const bool class_decides = options_.harmonics_rule == HarmonicsRule::kPaper || is_narrow_edge(record.site);
  if (class_decides) classify();
  record.harmonics_reason = reason_for(record);
  if (!record.uses_harmonics()) return;
  if (!class_decides) classify();
  if (!record.harmonics) {
    HitDistances hits;
    record.harmonics = gather_harmonics(record.site, gather, counts, hits);
  }
  shape_record(record, rule, sharpness);
}

}  // namespace vrc
