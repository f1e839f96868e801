// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/guide.h"

#include <algorithm>
#include <cmath>

namespace vrc {
namespace {

constexpr float kDefensiveShare = 0.15f;   // of the warp's density: uniform
constexpr double kCellPixels = 12.0;       // of the lookup grid
constexpr int kRings = 2;                  // of cells around a site's: 24 pixels
constexpr std::size_t kNeighbours = 4;     // averaged
constexpr double kDistanceFalloff = 0.05;  // weight 1 / (1 + 0.05 d^2), d in pixels
constexpr double kSimilarNormal = 0.98;    // least cosine of normals
constexpr float kBelowOne = 0x1.fffep-1f;  // leaves room for the number of the cell

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

}  // namespace

void GuideHistogram::add(const KeptHistogram& other, float weight) {
  for (std::size_t i = 0; i < mean_square.size(); ++i) mean_square[i] += weight * other.mean_square(i);
}

KeptHistogram::KeptHistogram(const GuideHistogram& histogram) {
  for (std::size_t i = 0; i < upper_bits_.size(); ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(histogram.mean_square[i]);
    upper_bits_[i] = static_cast<std::uint16_t>((bits + 0x8000u) >> 16);  // to the nearest one
  }
}

GuideHistogram KeptHistogram::expanded() const {
  GuideHistogram result;
  result.add(*this, 1.0f);
  return result;
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

void GuideField::add(const RecordSite& site, std::shared_ptr<const KeptHistogram> histogram) {
  const Eigen::Vector2i cell = cell_of(site.point.position);
  cells_[static_cast<std::size_t>(cell.y() * columns_ + cell.x())].push_back(
      static_cast<std::uint32_t>(entries_.size()));
  entries_.push_back({site.point.position, site.point.normal, site.point.material, std::move(histogram)});
}

std::unique_ptr<GuideHistogram> GuideField::at(const RecordSite& site) const {
  struct Neighbour {
    double squared_distance;  // in pixels
    std::uint32_t entry;
    bool operator<(const Neighbour& o) const {
      return squared_distance != o.squared_distance ? squared_distance < o.squared_distance : entry < o.entry;
    }
  };
  std::vector<Neighbour> near;
  const Eigen::Vector2i center = cell_of(site.point.position);
  const auto look = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= columns_ || y >= rows_) return;
    for (const std::uint32_t i : cells_[static_cast<std::size_t>(y * columns_ + x)]) {
      const Entry& e = entries_[i];
      if (e.material != site.point.material || e.normal.dot(site.point.normal) < kSimilarNormal) continue;
      const double d2 =
          (e.position - site.point.position).squaredNorm() / (site.pixel_length * site.pixel_length);
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
  if (near.empty()) return nullptr;
  const std::size_t count = std::min(near.size(), kNeighbours);
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  auto result = std::make_unique<GuideHistogram>();
  for (std::size_t i = 0; i < count; ++i) {
    const double weight = 1.0 / (1.0 + kDistanceFalloff * near[i].squared_distance);
    result->add(*entries_[near[i].entry].histogram, static_cast<float>(weight));
  }
  return result;
}

}  // namespace vrc
