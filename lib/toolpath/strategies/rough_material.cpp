// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_material.hpp"

#include <cstring>
#include <span>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;

constexpr double kThinChip = 0.75;  // cells
constexpr int kRimPlaces = 96;      // on the half in front

/// The least of (x − i)² + height[i]² over all i, at places x that go up: each i is least on one stretch, and
/// the stretches follow one another as the i do.
class LowestParabolas {
 public:
  explicit LowestParabolas(size_t width) : lowest_(width), begins_(width) {}

  void Of(std::span<const int> heights) {
    heights_ = heights;
    count_ = at_ = 0;
    for (int i = 0; i < std::ssize(heights); ++i) {
      int begin = 0;
      while (count_ > 0 && (begin = BeginOf(lowest_[count_ - 1], i)) <= begins_[count_ - 1]) --count_;
      if (count_ == 0) begin = 0;
      lowest_[count_] = i, begins_[count_++] = begin;
    }
  }

  long At(int x) {
    while (at_ + 1 < count_ && begins_[at_ + 1] <= x) ++at_;
    const long away = x - lowest_[at_];
    return away * away + Squared(lowest_[at_]);
  }

 private:
  long Squared(int i) const {
    const long height = heights_[static_cast<size_t>(i)];
    return height * height;
  }
  /// The first place from 0 on at which `later` is lower than `i`, which stands before it.
  int BeginOf(int i, int later) const {
    const long apart = later - i;
    const long over = apart * (later + i) + Squared(later) - Squared(i);
    return over < 0 ? 0 : static_cast<int>(over / (2 * apart)) + 1;
  }

  std::span<const int> heights_;
  std::vector<int> lowest_, begins_;
  size_t count_ = 0, at_ = 0;
};

}  // namespace

std::vector<char> ThickerThan(const RoughGrid& grid, const std::vector<char>& stands, double thickness) {
  const double radius = thickness / 2;
  std::vector<char> kept(stands.size());
  for (size_t cell = 0; cell < kept.size(); ++cell) kept[cell] = stands[cell] == 0;
  const RoughMaterial around(grid, kept, radius);
  for (size_t cell = 0; cell < kept.size(); ++cell)
    kept[cell] = around.Distance(static_cast<int>(cell)) > radius;
  const RoughMaterial within(grid, kept, radius);
  for (size_t cell = 0; cell < kept.size(); ++cell)
    kept[cell] = stands[cell] != 0 && within.Distance(static_cast<int>(cell)) <= radius;
  return kept;
}

RoughMaterial::RoughMaterial(const RoughGrid& grid, std::vector<char> stands, double radius)
    : grid_(grid),
      stands_(std::move(stands)),
      radius_(radius),
      free_(static_cast<float>(radius / grid.cell - kThinChip)),
      reach_(static_cast<int>(std::ceil(2 * radius / grid.cell)) + 2),
      distance_(grid.size(), 0),
      swept_(grid.size(), -kFreshSweeps) {
  for (int i = 0; i < kRimPlaces; ++i) {
    const SineCosine turn = SinCos(kPi * ((i + 0.5) / kRimPlaces - 0.5));
    rim_.push_back((radius - kThinChip * grid.cell) * Vector2d(turn.cos, turn.sin));
  }
  Measure(0, 0, grid.columns, grid.rows);
}

RoughMaterial::Contact RoughMaterial::Meet(const Vector2d& place, const Vector2d& direction) const {
  Contact contact;
  const Vector2d left(-direction.y(), direction.x());
  for (const Vector2d& at : rim_) {
    const int cell = grid_.CellAt(place + at.x() * direction + at.y() * left);
    if (cell < 0 || !Meets(cell)) continue;
    contact.angle += kPi / kRimPlaces;
    contact.side += at.y();
  }
  return contact;
}

void RoughMaterial::Sweep(const Vector2d& from, const Vector2d& to, std::vector<int>& taken) {
  ++sweeps_;
  const Vector2d way = to - from;
  const double squared = way.squaredNorm(), reach = radius_ * radius_;
  const auto clamp = [](int value, int end) { return std::clamp(value, 0, end); };
  const int first_column = clamp(grid_.ColumnOf(std::min(from.x(), to.x()) - radius_), grid_.columns);
  const int end_column = clamp(grid_.ColumnOf(std::max(from.x(), to.x()) + radius_) + 1, grid_.columns);
  const int first_row = clamp(grid_.RowOf(std::min(from.y(), to.y()) - radius_), grid_.rows);
  const int end_row = clamp(grid_.RowOf(std::max(from.y(), to.y()) + radius_) + 1, grid_.rows);
  const auto width = static_cast<size_t>(std::max(0, end_column - first_column));
  for (int row = first_row; row < end_row; ++row) {
    char* const begin = stands_.data() + grid_.At(first_column, row);
    char* const end = begin + width;
    // Most cells stand no more, and memchr passes many at once.
    for (char* at = begin; (at = static_cast<char*>(std::memchr(at, 1, static_cast<size_t>(end - at))));
         ++at) {
      const auto cell = static_cast<int>(at - stands_.data());
      const Vector2d p = grid_.CentreOf(cell) - from;
      const double share = squared > 0 ? std::clamp(p.dot(way) / squared, 0.0, 1.0) : 0;
      if ((p - share * way).squaredNorm() > reach) continue;
      *at = 0;
      swept_[static_cast<size_t>(cell)] = sweeps_;
      taken.push_back(cell);
    }
  }
}

void RoughMaterial::Restore(const std::vector<int>& taken) {
  for (const int cell : taken) stands_[static_cast<size_t>(cell)] = 1;
}

void RoughMaterial::Refresh(const std::vector<int>& taken) {
  if (taken.empty()) return;
  int low_column = grid_.columns, low_row = grid_.rows, high_column = 0, high_row = 0;
  for (const int cell : taken) {
    const int column = cell % grid_.columns, row = cell / grid_.columns;
    low_column = std::min(low_column, column), high_column = std::max(high_column, column);
    low_row = std::min(low_row, row), high_row = std::max(high_row, row);
  }
  Measure(std::max(0, low_column - reach_), std::max(0, low_row - reach_),
          std::min(grid_.columns, high_column + reach_ + 1), std::min(grid_.rows, high_row + reach_ + 1));
}

// First along columns, then along rows: √(across² + the column's own²) is least at the nearest cell.
void RoughMaterial::Measure(int first_column, int first_row, int end_column, int end_row) {
  const int wide_first = std::max(0, first_column - reach_),
            wide_end = std::min(grid_.columns, end_column + reach_);
  const int width = wide_end - wide_first, height = end_row - first_row;
  std::vector<int> upright(static_cast<size_t>(width) * static_cast<size_t>(height));
  const auto of_row = [&](int row) {
    return upright.data() + static_cast<size_t>(row - first_row) * static_cast<size_t>(width);
  };
  // Row after row, so that memory is read in its order.
  std::vector<int> last(static_cast<size_t>(width), reach_);
  const auto pass = [&](int row) {
    const char* stands = stands_.data() + grid_.At(wide_first, row);
    for (size_t i = 0; i < last.size(); ++i) last[i] = stands[i] != 0 ? 0 : std::min(last[i] + 1, reach_);
  };
  for (int row = std::max(0, first_row - reach_); row < end_row; ++row) {
    pass(row);
    if (row >= first_row) std::ranges::copy(last, of_row(row));
  }
  std::ranges::fill(last, reach_);
  for (int row = std::min(grid_.rows, end_row + reach_) - 1; row >= first_row; --row) {
    pass(row);
    int* const own = of_row(row);
    for (size_t i = 0; row < end_row && i < last.size(); ++i) own[i] = std::min(own[i], last[i]);
  }
  LowestParabolas nearest(static_cast<size_t>(width));
  for (int row = first_row; row < end_row; ++row) {
    nearest.Of({of_row(row), static_cast<size_t>(width)});
    for (int column = first_column; column < end_column; ++column)
      distance_[static_cast<size_t>(grid_.At(column, row))] =
          std::sqrt(static_cast<float>(nearest.At(column - wide_first)));
  }
}

}  // namespace millpose
