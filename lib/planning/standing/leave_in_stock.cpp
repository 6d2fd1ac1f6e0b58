// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/standing/leave_in_stock.hpp"

#include <fmt/format.h>

#include "base/parallel.hpp"
#include "machine/collision/tool_bodies.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "planning/result/skipped.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// Where the tool stands on the part, P, and at which of the pass's points.
struct ToolPlace {
  Pose X_PT;
  int point = 0;
};

/// One piece as the tool mills it.
struct MilledPiece {
  std::vector<ToolPlace> approach, cut, retract;  ///< the ends of the cut stand in all of them
};

ToolPlace AtPoint(const PlanResult& plan, const PassResult& pass, int number) {
  return {ToolAt(plan, pass, static_cast<size_t>(number)), number};
}

/// `to` and `from` stand in W with the external axes where they are at the piece's end.
MilledPiece Mill(const PlanResult& plan, const PassResult& pass, const Segment& piece, const LinkMove* to,
                 const LinkMove* from) {
  MilledPiece milled;
  for (int t = piece.first; t <= piece.last; ++t)
    if (pass.points[static_cast<size_t>(t)].skip == Infeasibility::kNone)
      milled.cut.push_back(AtPoint(plan, pass, t));
  if (piece.closed) milled.cut.push_back(milled.cut.front());
  const auto on_part = [&](const Pose& X_WT, int point) -> ToolPlace {
    return {PartAt(plan, ExternalAt(pass, static_cast<size_t>(point))).inverse(Eigen::Isometry) * X_WT,
            point};
  };
  if (to && to->planned)
    milled.approach = {on_part(to->X_WT_approach, milled.cut.front().point), milled.cut.front()};
  if (from && from->planned)
    milled.retract = {milled.cut.back(), on_part(from->X_WT_retracted, milled.cut.back().point)};
  return milled;
}

CutterPlace CutterAt(const ToolPlace& place) {
  return {place.X_PT.translation(), place.X_PT.linear().col(2)};
}

std::vector<CutterMotion> MotionsOf(const std::vector<ToolPlace>& cut) {
  std::vector<CutterMotion> motions;
  for (size_t i = 0; i + 1 < cut.size(); ++i) motions.push_back({CutterAt(cut[i]), CutterAt(cut[i + 1]), 0});
  if (cut.size() == 1) motions.push_back({CutterAt(cut.front()), CutterAt(cut.front()), 0});
  return motions;
}

/// From `a` to `b` in steps on which no point of the tool travels more than `travel`; without `b`.
void AddBetween(const ToolPlace& a, const ToolPlace& b, double travel, double reach,
                std::vector<ToolPlace>& places) {
  const Eigen::Matrix3d R = a.X_PT.linear();
  const Eigen::Vector3d turn = RotationVector(b.X_PT.linear() * R.transpose());
  const double way = (b.X_PT.translation() - a.X_PT.translation()).norm() + reach * turn.norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(way / travel)));
  for (int i = 0; i < steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    ToolPlace place = a;
    place.X_PT.translation() += share * (b.X_PT.translation() - a.X_PT.translation());
    place.X_PT.linear() = FromRotationVector(share * turn) * R;
    places.push_back(place);
  }
}

/// What is met first.
struct Meeting {
  size_t place;
  size_t body;
};

class PieceCheck {
 public:
  PieceCheck(const ToolBodies& bodies, const CutterShape& cutter, double travel, const Execution& execution)
      : bodies_(bodies), cutter_(cutter), travel_(travel), execution_(execution) {}

  /// Takes the piece off the stock; or, where a body meets it, leaves it as it is and says what and where.
  std::string Mill(const MilledPiece& piece, StandingStock& stock) const {
    const std::vector<ToolPlace> way = Follow({&piece.approach, &piece.cut, &piece.retract});
    std::optional<Meeting> met = FirstMet(way, stock);
    if (!met) {
      Remove(piece.cut, stock);
      return "";
    }
    // Some of it the piece itself takes off before the body comes there.
    StandingStock now = stock;
    if (!piece.approach.empty()) Remove(piece.approach, now);  // a bore down to the first point
    std::vector<ToolPlace> part = Follow({&piece.approach});
    met = FirstMet(part, now);
    for (size_t t = 0; !met && t + 1 < piece.cut.size(); ++t) {
      const std::vector<ToolPlace> step{piece.cut[t], piece.cut[t + 1]};
      Remove(step, now);
      part = Follow({&step});
      met = FirstMet(part, now);
    }
    if (!met) {
      part = Follow({&piece.retract});
      met = FirstMet(part, now);
    }
    if (!met) {
      stock = std::move(now);
      return "";
    }
    const Eigen::Vector3d tip = part[met->place].X_PT.translation();
    return fmt::format(
        "{} would meet material that still stands, with the tip at x {:.1f}, y {:.1f}, z {:.1f} mm "
        "of the part",
        bodies_.Name(met->body), tip.x(), tip.y(), tip.z());
  }

 private:
  std::vector<ToolPlace> Follow(std::initializer_list<const std::vector<ToolPlace>*> parts) const {
    std::vector<ToolPlace> way;
    for (const auto* part : parts) {
      for (size_t i = 0; i + 1 < part->size(); ++i)
        AddBetween((*part)[i], (*part)[i + 1], travel_, bodies_.Reach(), way);
      if (!part->empty()) way.push_back(part->back());
    }
    return way;
  }

  std::optional<Meeting> FirstMet(const std::vector<ToolPlace>& way, const StandingStock& stock) const {
    constexpr size_t kTogether = 64;
    std::vector<std::optional<Meeting>> met((way.size() + kTogether - 1) / kTogether);
    ParallelFor(met.size(), execution_.Threads(), execution_.stop, [&](size_t part) {
      for (size_t i = part * kTogether; i < std::min((part + 1) * kTogether, way.size()); ++i)
        for (size_t body = 0; body < bodies_.size(); ++body)
          if (stock.Meets(bodies_.NearTo(body, way[i].X_PT))) {
            met[part] = {i, body};
            return;
          }
    });
    for (const auto& first : met)
      if (first) return first;
    return std::nullopt;
  }

  void Remove(const std::vector<ToolPlace>& cut, StandingStock& stock) const {
    stock.Remove(cutter_, MotionsOf(cut), execution_.Threads(), execution_.stop);
  }

  const ToolBodies& bodies_;
  CutterShape cutter_;
  double travel_;
  const Execution& execution_;
};

}  // namespace

namespace {

/// What the motions of a piece meet of the stock as it is at its beginning.
void LookForAir(const AirCheck& check, const std::vector<ToolPlace>& cut, const StandingStock& stock,
                const Execution& execution, std::vector<InAir>& air) {
  std::vector<InAir> met(cut.size(), InAir::kCuts);
  ParallelFor(cut.size(), execution.Threads(), execution.stop, [&](size_t i) {
    if (i > 0) met[i] = check.Of({CutterAt(cut[i - 1]), CutterAt(cut[i]), 0}, stock);
  });
  const int first = cut.front().point;
  for (size_t i = 1; i < cut.size(); ++i)
    if (cut[i].point != first) air[static_cast<size_t>(cut[i].point)] = met[i];
}

}  // namespace

CutsOfTool CutsOf(const PlanResult& plan, const CutterShape& cutter) {
  CutsOfTool cuts{cutter, {}};
  for (const PassResult& pass : plan.passes)
    for (const Segment& piece : pass.pieces)
      std::ranges::copy(MotionsOf(Mill(plan, pass, piece, nullptr, nullptr).cut),
                        std::back_inserter(cuts.motions));
  return cuts;
}

LeftInStock LeaveInStock(const Cell& cell, const CutterShape& cutter, double air_margin, StandingStock& stock,
                         const Execution& execution, PlanResult& plan) {
  LeftInStock left;
  StockFigures& figures = left.figures;
  figures.blank = stock.Volume();
  figures.spacing = stock.spacing();
  const double travel = std::max(stock.spacing(), cell.clearances.cutting);
  const ToolBodies bodies(cell, stock.spacing() * std::sqrt(0.5), travel);
  const PieceCheck check(bodies, cutter, travel, execution);
  const AirCheck air(cutter, air_margin, stock.spacing());
  size_t gap = 0;
  for (PassResult& pass : plan.passes) {
    left.air.emplace_back(pass.points.size(), InAir::kCuts);
    std::vector<std::pair<int, std::string>> met;
    for (const Segment& piece : pass.pieces) {
      const LinkMove* to = gap < plan.gaps.size() ? &plan.gaps[gap] : nullptr;
      const LinkMove* from = gap + 1 < plan.gaps.size() ? &plan.gaps[gap + 1] : nullptr;
      ++gap;
      const MilledPiece milled = Mill(plan, pass, piece, to, from);
      LookForAir(air, milled.cut, stock, execution, left.air.back());
      if (std::string why = check.Mill(milled, stock); !why.empty())
        met.emplace_back(piece.piece, std::move(why));
      execution.progress.Advance(1);
    }
    // From the last to the first: leaving one out renumbers those after it.
    for (auto at = met.rbegin(); at != met.rend(); ++at) {
      LeaveOut(pass, at->first, Infeasibility::kStock, at->second);
      ++figures.left_out;
    }
  }
  figures.removed = figures.blank - stock.Volume();
  return left;
}

}  // namespace millpose
