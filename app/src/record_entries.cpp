// SPDX-License-Identifier: GPL-3.0-or-later
#include "record_entries.h"

namespace vrc {
namespace {

/// Luminance of a jet of three channels.
Jet2 luminance_jet(const std::array<Jet2, 3>& rgb) {
  Jet2 sum;
  const std::array<std::array<double, 3>, 3> unit{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t c = 0; c < 3; ++c) {
    const double weight = luminance(unit[c]);
    sum.value += weight * rgb[c].value;
    sum.gradient += weight * rgb[c].gradient;
    sum.hessian += weight * rgb[c].hessian;
  }
  return sum;
}

RecordMapEntry entry_of(const RadianceRecord& record) {
  const ValidRegion& region = record.region;
  const Jet2 jet = luminance_jet(record.radiance);
  // Rows: the axes of the region in the frame of the derivatives.
  const Frame& frame = record.site.frame;
  Mat2 axes;
  axes << frame.tangent.dot(region.axis1), frame.bitangent.dot(region.axis1), frame.tangent.dot(region.axis2),
      frame.bitangent.dot(region.axis2);
  const Mat2 hessian = axes * jet.hessian * axes.transpose();

  RecordMapEntry entry;
  entry.position = region.center.cast<float>();
  entry.normal = region.normal.cast<float>();
  entry.axis1 = region.axis1.cast<float>();
  entry.axis2 = region.axis2.cast<float>();
  entry.radius1 = static_cast<float>(region.radius1);
  entry.radius2 = static_cast<float>(region.radius2);
  for (std::size_t c = 0; c < 3; ++c) {
    entry.radiance[static_cast<Eigen::Index>(c)] = static_cast<float>(record.radiance[c].value);
  }
  entry.gradient = (axes * jet.gradient).cast<float>();
  entry.hessian = Vec3(hessian(0, 0), hessian(0, 1), hessian(1, 1)).cast<float>();
  entry.region = static_cast<std::uint32_t>(record.site.point.region);
  entry.face = record.site.point.triangle;
  return entry;
}

}  // namespace

std::vector<RecordMapEntry> record_entries(const RadianceCache& cache) {
  std::vector<RecordMapEntry> entries;
  entries.reserve(cache.records().size());
  for (const RadianceRecord& record : cache.records()) entries.push_back(entry_of(record));
  return entries;
}

}  // namespace vrc
