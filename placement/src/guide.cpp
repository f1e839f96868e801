// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/guide.h"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "sampling_square.h"

namespace vrc {
namespace {

constexpr float kDefensiveShare = 0.15f;   // of the warp's density: uniform
constexpr double kCellPixels = 12.0;       // of the lookup grid
constexpr int kRings = 2;                  // of cells around a site's: 24 pixels
constexpr std::size_t kNeighbours = 8;     // averaged
constexpr double kDistanceFalloff = 0.05;  // weight 1 / (1 + 0.05 d^2), d in pixels
constexpr float kBelowOne = 0x1.fffep-1f;  // leaves room for the number of the cell
constexpr float kUnseen = 1e-2f;           // rays per steradian, of all, that tell nothing
constexpr float kSameCell = 1.5f;          // of a cell's extent: directions that differ by less are the same

/// Weights 1 2 1 in both directions, within the columns [begin, end), rows wrapping round.
void smooth_columns(const GuideHistogram& from, int begin, int end, GuideHistogram& to) {
  constexpr int kRows = GuideHistogram::kRows;
  const auto at = [&](int column, int row) {
    const int c = std::clamp(column, begin, end - 1);
    return from.mean_square[static_cast<std::size_t>(c * kRows + ((row + kRows) % kRows))];
  };
  const auto along_rows = [&](int column, int row) {
    return 0.25f * (at(column, row - 1) + 2.0f * at(column, row) + at(column, row + 1));
  };
  for (int column = begin; column < end; ++column) {
    for (int row = 0; row < kRows; ++row) {
      to.mean_square[static_cast<std::size_t>(column * kRows + row)] =
          0.25f *
          (along_rows(column - 1, row) + 2.0f * along_rows(column, row) + along_rows(column + 1, row));
    }
  }
}

/// What gathers found by one strategy in the same directions.
class Outlook {
 public:
  Outlook(const SamplingSquare& square, const GatherStrategy& strategy)
      : normal_(square.normal()),
        strategy_(strategy),
        inverse_(square.inverse(strategy)),
        probes_(probes(square, strategy, 0.0f)) {
    const V3x16 moved = probes(square, strategy, 1.0f) - probes_;
    tolerance_ = (kSameCell * kSameCell) * dot(moved, moved);
    cells_.resize(static_cast<std::size_t>(end() - begin()));
    if (const auto* power = std::get_if<CosinePowerInverse>(&inverse_))
      least_cosine_ = power->cosine_at(kUnseen / share());
  }

  /// Whether a square's cells lie where its own do, about.
  [[nodiscard]] bool agrees(const SamplingSquare& square, const GatherStrategy& strategy) const {
    if (strategy != strategy_) return false;
    const V3x16 off = probes(square, strategy, 0.0f) - probes_;
    return !any(dot(off, off) > tolerance_);
  }

  void add(const KeptHistogram& found, float weight) {
    found.add_to(cells_, static_cast<std::size_t>(begin()), weight);
    weight_ += weight;
  }

  /// Adds n L^2 and n, n how densely the gathers looked in a direction.
  void look(const V3x16& direction, F16& squares, F16& densities) const {
    // Most directions are beyond the narrow lobes, which a cosine tells.
    if (const auto* power = std::get_if<CosinePowerInverse>(&inverse_);
        power != nullptr && !any(dot(direction, power->axis()) > least_cosine_))
      return;
    const SampledFrom16 from = std::visit([&](const auto& inverse) { return inverse(direction); }, inverse_);
    const F16 density = select(dot(direction, normal_) > 0.0f, share() * from.pdf, F16{});
    if (!any(density > kUnseen)) return;
    const I16 cell = guide_cells(strategy_.begin + share() * from.u1, from.u2) - begin();
    squares += density * gather(cells_.data(), cell);
    densities += weight_ * density;
  }

 private:
  /// Directions all over the strategy's columns, from points that are moved by some cells.
  static V3x16 probes(const SamplingSquare& square, const GatherStrategy& s, float cells) {
    const F16 i = to_float(lane_index());
    const F16 u1 = s.begin + (s.end - s.begin) * (i + 0.5f) * (1.0f / kLanes);
    const F16 u2 = 0.618034f * i + cells / GuideHistogram::kRows;
    const float back = cells / GuideHistogram::kColumns;
    return square.direction(max(u1 - back, s.begin), u2 - floor(u2));
  }
  [[nodiscard]] float share() const { return strategy_.end - strategy_.begin; }
  [[nodiscard]] int begin() const { return static_cast<int>(strategy_.begin * kColumns) * kRows; }
  [[nodiscard]] int end() const { return static_cast<int>(strategy_.end * kColumns) * kRows; }

  static constexpr int kColumns = GuideHistogram::kColumns, kRows = GuideHistogram::kRows;
  V3x16 normal_;
  GatherStrategy strategy_;
  SampleInverse inverse_;
  V3x16 probes_;
  float least_cosine_ = 0.0f;  ///< With the axis of a power of a cosine, beyond which nothing is seen.
  F16 tolerance_;              ///< Squared, of the probes.
  float weight_ = 0.0f;
  std::vector<float> cells_;
};

/// What several gathers found.
class Findings {
 public:
  void add(const SamplingSquare& square, const KeptHistogram& found, float weight) {
    for (const GatherStrategy& s : square.strategies()) {
      auto own = std::ranges::find_if(outlooks_, [&](const Outlook& o) { return o.agrees(square, s); });
      if (own == outlooks_.end()) own = outlooks_.emplace(own, square, s);
      own->add(found, weight);
    }
  }
  [[nodiscard]] bool empty() const { return outlooks_.empty(); }

  /// Mean square of the luminance that arrives.
  [[nodiscard]] F16 mean_square(const V3x16& direction) const {
    F16 squares{}, densities{};
    for (const Outlook& o : outlooks_) o.look(direction, squares, densities);
    return squares / max(densities, 1e-20f);
  }

 private:
  std::vector<Outlook> outlooks_;
};

/// What the luminance that arrives from a direction is multiplied by in a gather: at the square's own site,
/// or on average at others that are seen like `views`.
F16 response(const SamplingSquare& square, std::span<const Directions16> views, const V3x16& direction) {
  const Directions16 own = square.with_camera(direction);
  F16 reflected{};
  for (const Directions16& view : views)
    reflected += luminance(f_cos(square.bsdf(), directions(view.n, view.wo, direction)));
  reflected = views.empty() ? luminance(f_cos(square.bsdf(), own))
                            : reflected * (1.0f / static_cast<float>(views.size()));
  return reflected / max(square.pdf(own), 1e-20f);
}

/// Mean squares of what a gather's rays would contribute at the cells' centres, by what others found.
GuideHistogram contributions(const SamplingSquare& square, const Findings& findings,
                             std::span<const Directions16> views) {
  constexpr int kColumns = GuideHistogram::kColumns, kRows = GuideHistogram::kRows;
  GuideHistogram result;
  // Packets of 4 x 4 cells: what lies in few directions matters to few of them.
  const I16 column_in_block = lane_index() & 3, row_in_block = lane_index() >> 2;
  for (int first_column = 0; first_column < kColumns; first_column += 4) {
    for (int first_row = 0; first_row < kRows; first_row += 4) {
      const I16 column = column_in_block + first_column, row = row_in_block + first_row;
      const V3x16 direction = square.direction((to_float(column) + 0.5f) * (1.0f / kColumns),
                                               (to_float(row) + 0.5f) * (1.0f / kRows));
      const F16 factor = response(square, views, direction);
      const F16 value = factor * factor * findings.mean_square(direction);
      const I16 cell = column * kRows + row;
      for (int lane = 0; lane < kLanes; ++lane)
        result.mean_square[static_cast<std::size_t>(cell[lane])] = value[lane];
    }
  }
  return result;
}

std::vector<int> first_columns(const SamplingSquare& square) {
  std::vector<int> result;
  for (const GatherStrategy& s : square.strategies())
    result.push_back(static_cast<int>(s.begin * GuideHistogram::kColumns));
  return result;
}

}  // namespace

KeptHistogram::KeptHistogram(const GuideHistogram& histogram) {
  for (std::size_t i = 0; i < upper_bits_.size(); ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(histogram.mean_square[i]);
    upper_bits_[i] = static_cast<std::uint16_t>((bits + 0x8000u) >> 16);  // to the nearest one
  }
}

void KeptHistogram::add_to(std::span<float> cells, std::size_t first, float weight) const {
  const std::uint16_t* const from = upper_bits_.data() + first;
  float* const to = cells.data();
  for (std::size_t i = 0; i < cells.size(); ++i)
    to[i] += weight * std::bit_cast<float>(std::uint32_t{from[i]} << 16);
}

GuideWarp::GuideWarp(const GuideHistogram& histogram, const std::vector<int>& first_columns) {
  GuideHistogram smooth;
  for (std::size_t i = 0; i < first_columns.size(); ++i) {
    const int end = i + 1 < first_columns.size() ? first_columns[i + 1] : kColumns;
    smooth_columns(histogram, first_columns[i], end, smooth);
  }
  double mean = 0.0;
  for (float& v : smooth.mean_square) {
    v = std::sqrt(v);
    mean += static_cast<double>(v) / GuideHistogram::kCells;
  }
  const float scale = mean > 0.0 ? (1.0f - kDefensiveShare) / static_cast<float>(mean) : 0.0f;
  const float floor = mean > 0.0 ? kDefensiveShare : 1.0f;
  for (std::size_t i = 0; i < density_.size(); ++i) density_[i] = floor + scale * smooth.mean_square[i];
  float before = 0.0f;
  for (int c = 0; c < kColumns; ++c) {
    const auto first = static_cast<std::size_t>(c * kRows);
    float sum = 0.0f;
    for (std::size_t r = 0; r < kRows; ++r) {
      row_start_[first + r] = sum;
      sum += density_[first + r];
    }
    for (std::size_t r = 0; r < kRows; ++r) row_start_[first + r] /= sum;
    column_start_[static_cast<std::size_t>(c)] = before;
    column_share_[static_cast<std::size_t>(c)] = sum / GuideHistogram::kCells;
    before += sum / GuideHistogram::kCells;
  }
}

GuideWarp::Point16 GuideWarp::operator()(F16 v1, F16 v2) const {
  I16 column = splat(-1);
  for (const float start : column_start_) column -= v1 >= start;  // a true mask is -1
  const F16 within_column =
      (v1 - gather(column_start_.data(), column)) / gather(column_share_.data(), column);

  const I16 first = column * kRows;
  I16 row{};
  for (int step = kRows / 2; step > 0; step /= 2) {
    row = select(v2 >= gather(row_start_.data(), first + row + step), row + step, row);
  }
  const F16 density = gather(density_.data(), first + row);
  // The share of a cell in its column is density / (kCells * share of the column).
  const F16 row_share =
      density / (gather(column_share_.data(), column) * static_cast<float>(GuideHistogram::kCells));
  const F16 within_row = (v2 - gather(row_start_.data(), first + row)) / row_share;
  const auto inside = [](F16 v) { return min(max(v, 0.0f), kBelowOne); };
  return {(to_float(column) + inside(within_column)) * (1.0f / kColumns),
          (to_float(row) + inside(within_row)) * (1.0f / kRows), density};
}

I16 guide_cells(F16 u1, F16 u2) {
  constexpr int kColumns = GuideHistogram::kColumns, kRows = GuideHistogram::kRows;
  const I16 column = to_int(min(u1 * kColumns, static_cast<float>(kColumns - 1)));
  const I16 row = to_int(min(u2 * kRows, static_cast<float>(kRows - 1)));
  return column * kRows + row;
}

GuideField::GuideField(const Scene& scene)
    : scene_(scene),
      columns_(static_cast<int>(scene.camera().width / kCellPixels) + 1),
      rows_(static_cast<int>(scene.camera().height / kCellPixels) + 1),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

Eigen::Vector2i GuideField::cell_of(const Vec3& position) const {
  const Vec2 film = scene_.camera().film_position(position) / kCellPixels;
  return {std::clamp(static_cast<int>(film.x()), 0, columns_ - 1),
          std::clamp(static_cast<int>(film.y()), 0, rows_ - 1)};
}

void GuideField::add(const RecordSite& site, std::shared_ptr<const KeptHistogram> found) {
  const Eigen::Vector2i cell = cell_of(site.point.position);
  cells_[static_cast<std::size_t>(cell.y() * columns_ + cell.x())].push_back(
      static_cast<std::uint32_t>(entries_.size()));
  entries_.push_back({site.point.position, site.frame.normal, site.to_camera.normalized(),
                      site.point.material, std::move(found)});
}

std::vector<GuideField::Near> GuideField::nearest(const RecordSite& site) const {
  std::vector<Near> near;
  const Eigen::Vector2i center = cell_of(site.point.position);
  const auto look = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= columns_ || y >= rows_) return;
    for (const std::uint32_t i : cells_[static_cast<std::size_t>(y * columns_ + x)]) {
      const double d2 = (entries_[i].position - site.point.position).squaredNorm() /
                        (site.pixel_length * site.pixel_length);
      const double reach = kRings * kCellPixels;
      if (d2 <= reach * reach) near.push_back({d2, i});
    }
  };
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int y = -ring; y <= ring; ++y) {
      const int step = std::abs(y) == ring ? 1 : 2 * ring;
      for (int x = -ring; x <= ring; x += std::max(step, 1)) look(center.x() + x, center.y() + y);
    }
    if (near.size() >= kNeighbours) break;
  }
  const std::size_t count = std::min(near.size(), kNeighbours);
  std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(count), {},
                            [](const Near& n) { return std::pair(n.squared_distance, n.entry); });
  near.resize(count);
  return near;
}

std::unique_ptr<const GuideWarp> GuideField::warp_at(const RecordSite& site, const KeptHistogram* own,
                                                     std::span<const Directions16> views) const {
  const auto square_of = [&](std::int32_t material, const Vec3& normal, const Vec3& to_camera) {
    return SamplingSquare(scene_.bsdfs()[static_cast<std::size_t>(material)], GatherDirections::kMixture,
                          normal, to_camera);
  };
  const SamplingSquare square =
      square_of(site.point.material, site.frame.normal, site.to_camera.normalized());
  Findings findings;
  for (const Near& near : nearest(site)) {
    const Entry& e = entries_[near.entry];
    findings.add(square_of(e.material, e.normal, e.to_camera), *e.found,
                 static_cast<float>(1.0 / (1.0 + kDistanceFalloff * near.squared_distance)));
  }
  if (own != nullptr) findings.add(square, *own, 1.0f);
  if (findings.empty()) return nullptr;
  return std::make_unique<const GuideWarp>(contributions(square, findings, views), first_columns(square));
}

}  // namespace vrc
