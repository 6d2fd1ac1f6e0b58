// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_layer.hpp"

#include "base/parallel.hpp"
#include "toolpath/strategies/rough_entry.hpp"
#include "toolpath/strategies/rough_way.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr size_t kFewCells = 8;        // a cut that takes off fewer is none
constexpr double kOverMaterial = 1;    // mm: where an entry begins
constexpr double kBesideMaterial = 1;  // mm from material: where the tool comes down
constexpr int kSeen = 4;               // cells about a front's cell that tell where the material lies
constexpr int kStride = 3;             // cells of a step along a front

class Clearing {
 public:
  Clearing(RoughMaterial& material, const RoughRoom& room, const std::vector<float>& tops,
           const RoughLayerOptions& options)
      : material_(material),
        grid_(material.grid()),
        room_(room),
        tops_(tops),
        options_(options),
        air_(material, room),
        tried_(grid_.size(), 0),
        seen_(grid_.size(), 0),
        given_up_(grid_.size(), 0) {}

  RoughLayer Run(const std::stop_token& stop) {
    for (bool again = true; again;) {
      again = false;
      while (GoOn() || BeginInTheOpen() || BeginInside()) {
        CheckStop(stop);
        again = true;
      }
      std::ranges::fill(tried_, 0);
    }
    TellWhatIsLeft();
    return std::move(layer_);
  }

 private:
  /// Where the tip may stand and would cut.
  bool IsToDo(int cell) const { return room_.At(cell) >= 0 && !material_.IsFree(cell); }

  bool IsBesideToDo(int cell) const {
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const int column = cell % grid_.columns + j, row = cell / grid_.columns + i;
        if (grid_.Has(column, row) && IsToDo(grid_.At(column, row))) return true;
      }
    return false;
  }

  /// Whether the tip may stand in a cell without cutting, next to where it would cut.
  bool IsOnFront(int cell) const {
    return room_.At(cell) >= 0 && material_.IsFree(cell) && IsBesideToDo(cell);
  }

  /// Against the way of a cut along the front there; zero where none is seen.
  Vector2d Upstream(int cell) const {
    Vector2d towards = Vector2d::Zero();
    for (int i = -kSeen; i <= kSeen; ++i)
      for (int j = -kSeen; j <= kSeen; ++j) {
        const int column = cell % grid_.columns + j, row = cell / grid_.columns + i;
        if (grid_.Has(column, row) && IsToDo(grid_.At(column, row))) towards += Vector2d(j, i);
      }
    const double sign = options_.march.climb ? 1 : -1;
    const Vector2d upstream = sign * Vector2d(towards.y(), -towards.x());
    return upstream.norm() > 0 ? Vector2d(upstream.normalized()) : Vector2d::Zero();
  }

  /// The front from a cell on, against the way of a cut along it; its last cell is where such a cut begins.
  /// Cuts from anywhere would eat fronts in crumbs, each with a way of its own. Ends where it was looked at.
  std::vector<int> FrontBefore(int cell) {
    constexpr double kAlong = 0.3;  // cells
    std::vector<int> front{cell};
    ++walk_;
    for (;;) {
      seen_[static_cast<size_t>(cell)] = walk_;
      const Vector2d upstream = Upstream(cell);
      int next = -1;
      double best = kAlong;
      for (int i = -kStride; i <= kStride; ++i)
        for (int j = -kStride; j <= kStride; ++j) {
          const int column = cell % grid_.columns + j, row = cell / grid_.columns + i;
          if (!grid_.Has(column, row) || upstream.dot(Vector2d(j, i)) <= best) continue;
          const int other = grid_.At(column, row);
          if (seen_[static_cast<size_t>(other)] == walk_ || !IsOnFront(other)) continue;
          next = other, best = upstream.dot(Vector2d(j, i));
        }
      if (next < 0) return front;
      cell = next;
      front.push_back(cell);
      if (tried_[static_cast<size_t>(cell)] != 0) return front;
    }
  }

  /// Whether a cut is made from where the front at a cell begins; it is kept in `cut_`.
  bool Cuts(int cell) {
    if (tried_[static_cast<size_t>(cell)] != 0 || !IsOnFront(cell)) return false;
    const std::vector<int> front = FrontBefore(cell);
    begin_ = front.back();
    if (CutsFromBegin()) return true;
    for (const int of_front : front) tried_[static_cast<size_t>(of_front)] = 1;
    return false;
  }

  bool CutsFromBegin() {
    char& tried = tried_[static_cast<size_t>(begin_)];
    if (tried != 0) return false;
    tried = 1;
    const Vector2d place = grid_.CentreOf(begin_);
    const auto direction = RoughStart(material_, room_, options_.march, place);
    if (!direction) return false;
    cut_ = RoughMarch(material_, room_, options_.march, place, *direction);
    if (cut_.taken.size() >= kFewCells) return true;
    material_.Restore(cut_.taken);
    return false;
  }

  void Append(const std::vector<Vector2d>& way, size_t first, RoughMotion motion) {
    for (size_t i = first; i < way.size(); ++i)
      layer_.passes.back().push_back({{way[i].x(), way[i].y(), options_.floor}, motion});
    if (!way.empty()) at_ = way.back();
  }

  void AppendCut() {
    Append(RoughThinned(cut_.way, room_, options_.chord), 1, RoughMotion::kCut);
    material_.Refresh(cut_.taken);
  }

  bool GoOn() {
    if (layer_.passes.empty()) return false;
    air_.Begin(at_);
    if (air_.Find([this](int cell) { return Cuts(cell); }) < 0) return false;
    // Where the front begins need not be what was reached first.
    const auto way = air_.WayTo(begin_);
    if (way.empty()) {
      layer_.passes.emplace_back();
      Append({grid_.CentreOf(begin_)}, 0, RoughMotion::kAir);
    }
    Append(way, 1, RoughMotion::kAir);
    AppendCut();
    return true;
  }

  bool BeginInTheOpen() {
    std::vector<std::pair<double, int>> cells;
    for (int cell = 0; cell < static_cast<int>(grid_.size()); ++cell)
      if (tried_[static_cast<size_t>(cell)] == 0 && IsOnFront(cell))
        cells.emplace_back((grid_.CentreOf(cell) - at_).squaredNorm(), cell);
    std::ranges::sort(cells);
    for (const auto& [away, cell] : cells) {
      if (!Cuts(cell)) continue;
      const Vector2d begin = grid_.CentreOf(begin_);
      air_.Begin(begin);
      const int beside = air_.Find([this](int other) {
        return material_.Distance(other) >= options_.cutter.radius + kBesideMaterial;
      });
      std::vector<Vector2d> way{begin};
      if (beside >= 0) way = air_.WayTo(beside);
      std::ranges::reverse(way);
      layer_.passes.emplace_back();
      Append(way, 0, RoughMotion::kAir);
      AppendCut();
      return true;
    }
    return false;
  }

  bool BeginInside() {
    int best = -1;
    for (int cell = 0; cell < static_cast<int>(grid_.size()); ++cell)
      if (given_up_[static_cast<size_t>(cell)] == 0 && IsToDo(cell) &&
          (best < 0 || room_.At(cell) > room_.At(best)))
        best = cell;
    if (best < 0) return false;
    GiveUpAround(best);  // one entry for each place that hangs together
    const Vector2d place = grid_.CentreOf(best);
    const double disc = material_.radius();
    const double top = std::min<double>(options_.above, TopAround(place, disc + options_.cutter.radius));
    const std::vector<Vector3d> entry =
        RoughEntry(room_, options_, place, room_.At(best), disc, top + kOverMaterial);
    if (entry.empty()) {
      layer_.without_entry = true;
      return true;
    }
    Enter(entry);
    return true;
  }

  void Enter(const std::vector<Vector3d>& entry) {
    std::vector<RoughVertex>& pass = layer_.passes.emplace_back();
    std::vector<int> taken;
    for (size_t i = 0; i < entry.size(); ++i) {
      pass.push_back({entry[i], RoughMotion::kEntry});
      if (i > 0 && entry[i].z() == options_.floor && entry[i - 1].z() == options_.floor)
        material_.Sweep(entry[i - 1].head<2>(), entry[i].head<2>(), taken);
    }
    const Vector2d end = entry.back().head<2>();
    const Vector2d heading = (end - entry[entry.size() - 2].head<2>()).normalized();
    cut_ = RoughMarch(material_, room_, options_.march, end, heading);
    at_ = end;
    AppendCut();
    material_.Refresh(taken);
  }

  void GiveUpAround(int cell) {
    std::vector<int> open{cell};
    given_up_[static_cast<size_t>(cell)] = 1;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) {
          const int column = at % grid_.columns + j, row = at / grid_.columns + i;
          if (!grid_.Has(column, row)) continue;
          char& given_up = given_up_[static_cast<size_t>(grid_.At(column, row))];
          if (given_up != 0 || !IsToDo(grid_.At(column, row))) continue;
          given_up = 1;
          open.push_back(grid_.At(column, row));
        }
    }
  }

  double TopAround(const Vector2d& place, double radius) const {
    double top = options_.floor;
    for (int cell = 0; cell < static_cast<int>(grid_.size()); ++cell)
      if ((grid_.CentreOf(cell) - place).norm() <= radius)
        top = std::max<double>(top, tops_[static_cast<size_t>(cell)]);
    return top;
  }

  void TellWhatIsLeft() {
    std::vector<char> open(grid_.size(), 0);
    for (size_t cell = 0; cell < open.size(); ++cell) open[cell] = room_.At(static_cast<int>(cell)) >= 0;
    const RoughMaterial reached(grid_, std::move(open), material_.radius());
    for (int cell = 0; cell < static_cast<int>(grid_.size()); ++cell) {
      if (!material_.Stands(cell) || reached.Distance(cell) > material_.radius() - grid_.cell) continue;
      if (layer_.left == 0) layer_.left_at = grid_.CentreOf(cell);
      layer_.left += grid_.cell * grid_.cell;
    }
  }

  RoughMaterial& material_;
  RoughGrid grid_;
  const RoughRoom& room_;
  const std::vector<float>& tops_;
  const RoughLayerOptions& options_;
  RoughAir air_;
  std::vector<char> tried_;  ///< the front there was looked at
  std::vector<int> seen_;    ///< by the last walk along a front that came there
  int walk_ = 0;
  std::vector<char> given_up_;
  RoughCut cut_;
  int begin_ = 0;  ///< where `cut_` begins
  RoughLayer layer_;
  Vector2d at_ = Vector2d::Zero();
};

}  // namespace

RoughLayer RoughLayerOf(RoughMaterial material, const RoughRoom& room, const std::vector<float>& tops,
                        const RoughLayerOptions& options, const std::stop_token& stop) {
  return Clearing(material, room, tops, options).Run(stop);
}

}  // namespace millpose
