// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/site_curvature.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "placement/record.h"
#include "placement/record_maker.h"
#include "placement/surface_reach.h"

namespace vrc {
namespace {

constexpr double kFlatTurn = 1e-6;  // [rad]

/// sigma_max(S A): the turn of the normal over the ellipse to first order.
double ellipse_deviation(const RadianceRecord& record) {
  const Mat2 turn = record.site.point.shape_operator * half_axes(record.region, record.site.frame);
  return turn.jacobiSvd().singularValues()[0];
}

}  // namespace

std::string_view name_of(CurvatureReason reason) {
  constexpr std::array<std::string_view, kCurvatureReasons> kNames = {"flat", "turns-little", "ellipse-turns",
                                                                      "surface-turns"};
  return kNames[static_cast<std::size_t>(reason)];
}

SiteCurvature classify_site(const SceneCharts& charts, const RadianceRecord& record, double theta_max) {
  const SurfacePoint& point = record.site.point;
  SiteCurvature site;
  site.exponent =
      static_cast<double>(charts.scene().bsdfs()[static_cast<std::size_t>(point.material)].sharpness());
  // A flat face may still bend elsewhere in its region: the walk decides.
  const double by_ellipse = ellipse_deviation(record);
  const double by_walk = walked_deviation(charts, point, record.region);
  site.deviation = std::max(by_ellipse, by_walk);
  const Vec2 principal = point.shape_operator.selfadjointView<Eigen::Lower>().eigenvalues();
  site.curvature = principal.cwiseAbs().maxCoeff();
  if (record.estimate.hits.mean_inverse > 0.0)
    site.relative_curvature = site.curvature / record.estimate.hits.mean_inverse;
  site.reason = site.deviation <= kFlatTurn   ? CurvatureReason::kFlat
                : site.deviation <= theta_max ? CurvatureReason::kTurnsLittle
                : by_ellipse > theta_max      ? CurvatureReason::kEllipseTurns
                                              : CurvatureReason::kSurfaceTurns;
  return site;
}

}  // namespace vrc
