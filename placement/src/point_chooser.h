// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "placement/cache_options.h"
#include "placement/record.h"
#include "placement/visible_points.h"

namespace vrc {

/// Says which open points get the next records.
class PointChooser {
 public:
  virtual ~PointChooser() = default;
  /// Begins to cover the points anew; the records so far stay.
  virtual void start() = 0;
  /// At most `limit` open points, in the order in which they are admitted; none when no open point is
  /// left. `records` are all so far; those added since the last call lie at the points it returned.
  [[nodiscard]] virtual std::vector<std::uint32_t> choose(std::span<const RadianceRecord> records,
                                                          std::size_t limit) = 0;
  /// How much has been covered, in [0, 1].
  [[nodiscard]] virtual double progress() const = 0;
};

/// Takes open points in their order.
class OrderedChooser : public PointChooser {
 public:
  explicit OrderedChooser(const VisiblePoints& points) : points_(points) {}
  void start() override { next_ = 0; }
  std::vector<std::uint32_t> choose(std::span<const RadianceRecord> records, std::size_t limit) override;
  double progress() const override;

 private:
  const VisiblePoints& points_;
  std::size_t next_ = 0;
};

/// Takes the open points one by one, as the pixels are shaded line by line.
class LineChooser : public PointChooser {
 public:
  explicit LineChooser(const VisiblePoints& points);
  void start() override { next_ = 0; }
  std::vector<std::uint32_t> choose(std::span<const RadianceRecord> records, std::size_t limit) override;
  double progress() const override;

 private:
  const VisiblePoints& points_;
  std::vector<std::uint32_t> order_;
  std::size_t next_ = 0;
};

/// Grows an anisotropic Poisson-disk set over the surfaces: around the ellipse of each new record six
/// neighbours are sought at equal angles and equal distance in the ellipse's own metric, in the charts
/// that it reaches; when the front gives out, the gaps are filled next to the records there are, and
/// surfaces without records get a seed each. Two points of a round keep a distance of 1 in either one's
/// metric.
class FrontChooser : public PointChooser {
 public:
  FrontChooser(const SceneCharts& charts, const VisiblePoints& points) : charts_(charts), points_(points) {}
  void start() override;
  std::vector<std::uint32_t> choose(std::span<const RadianceRecord> records, std::size_t limit) override;
  double progress() const override;

 private:
  static constexpr std::size_t kSectors = 6;
  /// An open point beside a record.
  struct Proposal {
    std::uint32_t point = kInvalidIndex;
    std::uint32_t parent = kInvalidIndex;  ///< None: a seed.
    float misfit = 0.0f;  ///< Squared distance from where it was sought, in the parent's metric.
  };
  using Neighbours = std::array<Proposal, kSectors>;

  [[nodiscard]] Neighbours neighbours(std::span<const RadianceRecord> records, std::uint32_t parent) const;
  /// Adds the neighbours of `parents` that keep their distance to `admitted`, until it has `limit`; those
  /// of the parents that have open points beside them become active.
  void admit(std::span<const RadianceRecord> records, std::span<const std::uint32_t> parents,
             float most_misfit, std::size_t limit, std::vector<Proposal>& admitted);
  void add_seeds(std::size_t limit, std::vector<Proposal>& admitted);

  const SceneCharts& charts_;
  const VisiblePoints& points_;
  std::size_t known_ = 0;                      ///< Records that have been looked at.
  std::vector<std::uint32_t> parents_;         ///< Of the records: the record beside which each was placed.
  std::vector<std::uint32_t> chosen_parents_;  ///< Of the points returned last.
  std::vector<std::uint32_t> active_;          ///< Records that may have open points beside them.
  std::size_t first_open_ = 0;
};

}  // namespace vrc
