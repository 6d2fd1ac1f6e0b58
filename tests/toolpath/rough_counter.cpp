// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/toolpath/rough_counter.hpp"

#include <algorithm>
#include <cmath>

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNoStock = -1e9;
constexpr double kThin = 0.25;   // mm: thinner chips are not counted
constexpr double kStep = 0.25;   // mm between places that are looked at
constexpr double kAbove = 0.05;  // mm over the tip: below this it only touches

}  // namespace

RoughCounter::RoughCounter(const Vector2d& lower, const Vector2d& upper, double top, double cell,
                           std::vector<CountedBlock> part, const CountedCut& cut)
    : cell_(cell), part_(std::move(part)), cut_(cut) {
  const double beside = 2 * cut.radius + 6;
  origin_ = lower - Vector2d::Constant(beside);
  const Vector2d size = (upper - lower + Vector2d::Constant(2 * beside)) / cell;
  columns_ = static_cast<int>(std::ceil(size.x())), rows_ = static_cast<int>(std::ceil(size.y()));
  heights_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), kNoStock);
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j < columns_; ++j) {
      const Vector2d p = Centre(i, j);
      if ((p - lower).minCoeff() >= 0 && (upper - p).minCoeff() >= 0)
        heights_[static_cast<size_t>(i * columns_ + j)] = top;
    }
  begun_ = heights_;
}

Vector2d RoughCounter::Centre(int i, int j) const { return origin_ + cell_ * Vector2d(j + 0.5, i + 0.5); }

void RoughCounter::ForEachCell(const std::function<void(const Vector2d&, double)>& visit) const {
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j < columns_; ++j) {
      const auto k = static_cast<size_t>(i * columns_ + j);
      if (begun_[k] > kNoStock) visit(Centre(i, j), heights_[k]);
    }
}

void RoughCounter::Change(const CountedCut& cut) {
  cut_ = cut;
  in_air_ = engagement_ = plunge_ = slope_ = 0;
}

void RoughCounter::Mill(const Toolpath& toolpath) {
  for (const Pass& pass : toolpath.passes) {
    const Vector3d first = pass.points.front().position;
    for (int i = 0; i < rows_; ++i)
      for (int j = 0; j < columns_; ++j)
        if ((Centre(i, j) - first.head<2>()).norm() < cut_.radius - kThin)
          plunge_ = std::max(plunge_, heights_[static_cast<size_t>(i * columns_ + j)] - first.z());
    for (size_t k = 1; k < pass.points.size(); ++k) Come(pass.points[k - 1].position, pass.points[k]);
    while (!pending_.empty()) TakeFirst();
  }
}

void RoughCounter::Come(const Vector3d& from, const MillingPoint& to) {
  const Vector3d way = to.position - from;
  const double across = way.head<2>().norm();
  slope_ = std::max(slope_, -way.z() / std::max(across, 1e-9));
  const bool cuts = to.kind == PointKind::kCut && to.feed_rate == cut_.feed;
  const bool in_air = to.kind == PointKind::kCut && !cuts;
  if (to.kind == PointKind::kCut) levels_.push_back(to.position.z());
  const int steps = std::max(1, static_cast<int>(std::ceil(across / kStep)));
  while (!cuts && !pending_.empty()) TakeFirst();
  for (int k = 1; k <= steps; ++k) {
    const Vector3d tip = from + static_cast<double>(k) / steps * way;
    if (cuts) engagement_ = std::max(engagement_, Meets(tip, way.head<2>().normalized()));
    if (in_air) in_air_ = std::max(in_air_, Meets(tip, way.head<2>().normalized()));
    if (!cuts) {
      Take(tip, 0);
      continue;
    }
    // The rim's side meets what this cut itself has taken off a little before; so that is taken off later.
    pending_.push_back(tip);
    if (pending_.size() * kStep > std::sqrt(2 * kThin * cut_.radius) + kStep) TakeFirst();
  }
}

void RoughCounter::TakeFirst() {
  Take(pending_.front(), 0);
  pending_.pop_front();
}

double RoughCounter::Meets(const Vector3d& tip, const Vector2d& along) const {
  constexpr int kPlaces = 180;
  const double radius = cut_.radius - kThin;
  int met = 0;
  for (int k = 0; k < kPlaces; ++k) {
    const double angle = M_PI * ((k + 0.5) / kPlaces - 0.5);
    const Vector2d aside(-along.y(), along.x());
    const Vector2d p = tip.head<2>() + radius * (std::cos(angle) * along + std::sin(angle) * aside);
    const Vector2d at = (p - origin_) / cell_;
    const int j = static_cast<int>(std::floor(at.x())), i = static_cast<int>(std::floor(at.y()));
    if (i < 0 || j < 0 || i >= rows_ || j >= columns_) continue;
    met += heights_[static_cast<size_t>(i * columns_ + j)] > tip.z() + cut_.corner + kAbove;
  }
  return M_PI * met / kPlaces;
}

void RoughCounter::Take(const Vector3d& tip, double wider) {
  const double rim = cut_.radius + wider, flat = rim - cut_.corner;
  const Vector2d at = (tip.head<2>() - origin_) / cell_;
  const int reach = static_cast<int>(rim / cell_) + 1, row = static_cast<int>(at.y());
  for (int i = std::max(0, row - reach); i <= std::min(rows_ - 1, row + reach); ++i) {
    const double along_y = (i + 0.5) * cell_ + origin_.y() - tip.y();
    if (std::abs(along_y) > rim) continue;
    const double half = std::sqrt(rim * rim - along_y * along_y) / cell_;
    const int first = std::max(0, static_cast<int>(std::ceil(at.x() - half - 0.5)));
    const int last = std::min(columns_ - 1, static_cast<int>(std::floor(at.x() + half - 0.5)));
    double* heights = &heights_[static_cast<size_t>(i * columns_)];
    for (int j = first; j <= last; ++j) {
      if (heights[j] <= tip.z()) continue;  // as nearly everywhere, where it has been a moment before
      double low = tip.z();
      if (cut_.corner > 0) {
        const double out = std::max(0.0, (Centre(i, j) - tip.head<2>()).norm() - flat);
        low += cut_.corner - std::sqrt(std::max(0.0, cut_.corner * cut_.corner - out * out));
      }
      heights[j] = std::min(heights[j], low);
    }
  }
}

double RoughCounter::Removed() const {
  double sum = 0;
  for (size_t k = 0; k < heights_.size(); ++k)
    if (begun_[k] > kNoStock) sum += begun_[k] - heights_[k];
  return sum * cell_ * cell_;
}

double RoughCounter::DistanceFromPart(const Vector3d& p) const {
  double nearest = 1e9;
  for (const CountedBlock& block : part_) {
    const Vector3d out(std::max({block.lower.x() - p.x(), 0.0, p.x() - block.upper.x()}),
                       std::max({block.lower.y() - p.y(), 0.0, p.y() - block.upper.y()}),
                       std::max(0.0, p.z() - block.top));
    const double inside = std::min({p.x() - block.lower.x(), block.upper.x() - p.x(), p.y() - block.lower.y(),
                                    block.upper.y() - p.y(), block.top - p.z()});
    nearest = std::min(nearest, inside > 0 ? -inside : out.norm());
  }
  return nearest;
}

double RoughCounter::DeepestGouge() const {
  double deepest = -1e9;
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j < columns_; ++j) {
      const auto k = static_cast<size_t>(i * columns_ + j);
      if (heights_[k] >= begun_[k]) continue;
      const Vector2d p = Centre(i, j);
      deepest = std::max(deepest, cut_.allowance - DistanceFromPart({p.x(), p.y(), heights_[k]}));
    }
  return deepest;
}

double RoughCounter::Room(const Vector2d& p, double height) const {
  double room = 1e9;
  for (const CountedBlock& block : part_) {
    const double over = height + cut_.corner - block.top;  // of the corner's middle over the block
    const double grown = cut_.corner + cut_.allowance;
    if (over >= grown - 1e-6) continue;
    const double reach =
        cut_.radius - cut_.corner + (over <= 0 ? grown : std::sqrt(grown * grown - over * over));
    const Vector2d out = (block.lower - p).cwiseMax(p - block.upper).cwiseMax(0);
    room = std::min(room, out.norm() - reach);
  }
  return room;
}

double RoughCounter::Reachable() const {
  std::vector<double> levels = levels_;
  std::ranges::sort(levels, std::greater());
  levels.erase(
      std::unique(levels.begin(), levels.end(), [](double a, double b) { return std::abs(a - b) < 1e-6; }),
      levels.end());
  const RoughCounter begun = [&] {
    RoughCounter counter = *this;
    counter.heights_ = begun_;
    return counter;
  }();
  RoughCounter all = begun;
  for (const double level : levels) {
    for (int i = 0; i < rows_; ++i)
      for (int j = 0; j < columns_; ++j) {
        const Vector2d p = Centre(i, j);
        const double room = Room(p, level);
        if (room < 0) continue;
        double& height = all.heights_[static_cast<size_t>(i * columns_ + j)];
        height = std::min(height, level);
        // All places nearer than its room are allowed as well.
        if (room < 2 * cell_) all.Take({p.x(), p.y(), level}, room);
      }
  }
  return all.Removed();
}

}  // namespace millpose
