// SPDX-License-Identifier: GPL-3.0-or-later
#include "point_chooser.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "core/parallel.h"

namespace vrc {
namespace {

constexpr std::size_t kSmallestRound = 32;
constexpr std::size_t kRoundShare = 8;  // a round makes at most 1/8 of the records so far

constexpr double kSpacing = 1.65;   // distance of neighbours, in units of the radii
constexpr double kSearch = 2.2;     // how far gaps are filled from
constexpr float kCloseFit = 0.15f;  // squared misfit of a neighbour while the front advances
constexpr float kAnyFit = 100.0f;

/// The same ellipse for points that turn farther away, too.
ValidRegion turned_wider(ValidRegion region, double factor) {
  region.cos_max_deviation = std::cos(std::min(factor * std::acos(region.cos_max_deviation), 0.4 * kPi));
  return region;
}

}  // namespace

std::vector<std::uint32_t> OrderedChooser::choose(std::span<const RadianceRecord> records,
                                                  std::size_t limit) {
  const std::size_t round = std::min(std::max(kSmallestRound, records.size() / kRoundShare), limit);
  std::vector<std::uint32_t> chosen;
  for (; next_ < points_.size() && chosen.size() < round; ++next_) {
    if (points_.is_open(next_)) chosen.push_back(static_cast<std::uint32_t>(next_));
  }
  return chosen;
}

double OrderedChooser::progress() const {
  return static_cast<double>(next_) / static_cast<double>(std::max<std::size_t>(points_.size(), 1));
}

LineChooser::LineChooser(const VisiblePoints& points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  std::ranges::sort(order_, {}, [&](std::uint32_t i) { return points.turn(i); });
}

std::vector<std::uint32_t> LineChooser::choose(std::span<const RadianceRecord> /*records*/,
                                               std::size_t /*limit*/) {
  while (next_ < order_.size() && !points_.is_open(order_[next_])) ++next_;
  if (next_ == order_.size()) return {};
  return {order_[next_]};
}

double LineChooser::progress() const {
  return static_cast<double>(next_) / static_cast<double>(std::max<std::size_t>(order_.size(), 1));
}

void FrontChooser::start() {
  known_ = 0;
  active_.clear();
  chosen_parents_.clear();
  first_open_ = 0;
}

double FrontChooser::progress() const {
  return static_cast<double>(first_open_) / static_cast<double>(std::max<std::size_t>(points_.size(), 1));
}

FrontChooser::Neighbours FrontChooser::neighbours(std::span<const RadianceRecord> records,
                                                  std::uint32_t parent) const {
  const RadianceRecord& record = records[parent];
  const ValidRegion& region = record.region;
  // The lattice goes on in the direction from which the record was placed.
  double base = 0.0;
  if (parents_[parent] != kInvalidIndex) {
    const Vec3 d = records[parents_[parent]].region.center - region.center;
    base = std::atan2(d.dot(region.axis2) / region.radius2, d.dot(region.axis1) / region.radius1);
  }
  Neighbours best;
  const SurfaceReach reach =
      reach_over_surface(charts_, record.site.point, turned_wider(region, kSearch), kSearch);
  constexpr double kSectorAngle = 2.0 * kPi / kSectors;
  points_.for_each_open(region, reach, kSearch, [&](std::uint32_t i, float a, float b, float k2) {
    const double turns = (std::atan2(static_cast<double>(b), static_cast<double>(a)) - base) / kSectorAngle;
    const double sector = std::round(turns);
    const double k = std::sqrt(static_cast<double>(k2));
    // Law of cosines for the distance to (kSpacing, the sector's middle).
    const double misfit =
        k * k + kSpacing * kSpacing - 2.0 * k * kSpacing * std::cos((turns - sector) * kSectorAngle);
    Proposal& p =
        best[static_cast<std::size_t>(static_cast<int>(sector) + 2 * static_cast<int>(kSectors)) % kSectors];
    if (p.point == kInvalidIndex || misfit < static_cast<double>(p.misfit))
      p = {i, parent, static_cast<float>(misfit)};
  });
  return best;
}

void FrontChooser::admit(std::span<const RadianceRecord> records, std::span<const std::uint32_t> parents,
                         float most_misfit, std::size_t limit, std::vector<Proposal>& admitted) {
  std::vector<Neighbours> found(parents.size());
  parallel_for(parents.size(), [&](std::size_t i) { found[i] = neighbours(records, parents[i]); });
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    bool open = false;
    for (const Proposal& p : found[i]) {
      if (p.point == kInvalidIndex) continue;
      open = true;
      if (p.misfit <= most_misfit) proposals.push_back(p);
    }
    if (open) active_.push_back(parents[i]);
  }
  // What a limit leaves open should be spread over the picture, as the points are in their order.
  if (admitted.size() + proposals.size() > limit) std::ranges::sort(proposals, {}, &Proposal::point);
  const auto near = [&](const Proposal& p, const Vec3& d) {
    if (p.parent == kInvalidIndex) return false;
    const ValidRegion& r = records[p.parent].region;
    return translation_distance(r, r.center + d) < 1.0;
  };
  for (const Proposal& p : proposals) {
    if (admitted.size() >= limit) return;
    const Vec3 x = points_.position(p.point);
    const bool conflict = std::ranges::any_of(admitted, [&](const Proposal& other) {
      if (points_.region(other.point) != points_.region(p.point)) return false;
      const Vec3 d = points_.position(other.point) - x;
      return p.point == other.point || near(p, d) || near(other, d);
    });
    if (!conflict) admitted.push_back(p);
  }
}

void FrontChooser::add_seeds(std::size_t limit, std::vector<Proposal>& admitted) {
  std::set<std::int32_t> busy;  // smooth regions
  for (const Proposal& p : admitted) busy.insert(points_.region(p.point));
  while (first_open_ < points_.size() && !points_.is_open(first_open_)) ++first_open_;
  for (std::size_t i = first_open_; i < points_.size() && admitted.size() < limit; ++i) {
    if (points_.is_open(i) && busy.insert(points_.region(i)).second)
      admitted.push_back({static_cast<std::uint32_t>(i), kInvalidIndex, 0.0f});
  }
}

std::vector<std::uint32_t> FrontChooser::choose(std::span<const RadianceRecord> records, std::size_t limit) {
  // Records that were there before, or were made by someone else, have no parent.
  parents_.resize(records.size() - std::min(records.size() - known_, chosen_parents_.size()), kInvalidIndex);
  for (const std::uint32_t parent : chosen_parents_) {
    if (parents_.size() < records.size()) parents_.push_back(parent);
  }
  chosen_parents_.clear();
  std::vector<std::uint32_t> front;
  for (; known_ < records.size(); ++known_) front.push_back(static_cast<std::uint32_t>(known_));
  std::vector<Proposal> admitted;
  admit(records, front, kCloseFit, limit, admitted);
  // Few at a time would leave processors idle.
  if (admitted.size() < kSmallestRound) {
    std::ranges::sort(active_);
    const std::vector<std::uint32_t> all = std::exchange(active_, {});
    admit(records, all, kAnyFit, limit, admitted);
    add_seeds(limit, admitted);
  }
  std::vector<std::uint32_t> chosen;
  for (const Proposal& p : admitted) {
    chosen.push_back(p.point);
    chosen_parents_.push_back(p.parent);
  }
  return chosen;
}

}  // namespace vrc
