// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/links/station_link_move.hpp"

#include "machine/collision/station_path.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// From rest to rest, s.
double AxisDuration(double way, double speed, double acceleration) {
  return way * acceleration >= speed * speed ? way / speed + speed / acceleration
                                             : 2 * std::sqrt(way / acceleration);
}

double MoveDuration(const ExternalMove& move, const std::vector<ExternalAxis>& axes, double share) {
  double longest = 0;
  for (size_t i = 0; i < axes.size(); ++i)
    longest = std::max(longest, AxisDuration(std::abs(move.to[i] - move.from[i]), share * axes[i].speed,
                                             share * axes[i].acceleration));
  return longest;
}

/// No way at all: the arm is at home.
LinkMove Stay(const Joints& home) {
  LinkMove stay;
  stay.planned = true;
  stay.joints = {home};
  stay.clearance = std::numeric_limits<double>::infinity();
  return stay;
}

}  // namespace

LinkMove ByWayOfHome(const LinkMove& out, const LinkMove& in) {
  LinkMove gap = out;
  gap.to_pass = in.to_pass;
  gap.to_piece = in.to_piece;
  gap.X_WT_approach = in.X_WT_approach;
  gap.joints.insert(gap.joints.end(), in.joints.begin() + 1, in.joints.end());
  gap.clearance = std::min(out.clearance, in.clearance);
  gap.clearance_share = std::min(out.clearance_share, in.clearance_share);
  gap.duration += in.duration;
  if (gap.detail.empty()) gap.detail = in.detail;
  return gap;
}

LinkMove PlanStationLinkMove(const Stations& stations, const LinkMoveEnd& from, const LinkMoveEnd& to,
                             const LinkMoveOptions& options, std::stop_token stop) {
  if (from.external == to.external)
    return PlanLinkMove(stations.At(from.external).world, from, to, options, std::move(stop));
  const Cell& cell = stations.world().cell();
  const LinkMoveEnd leaving{-1, -1, cell.home, from.external}, coming{-1, -1, cell.home, to.external};
  const LinkMove out = from.pass < 0
                           ? Stay(cell.home)
                           : PlanLinkMove(stations.At(from.external).world, from, leaving, options, stop);
  const LinkMove in =
      to.pass < 0 ? Stay(cell.home) : PlanLinkMove(stations.At(to.external).world, coming, to, options, stop);
  ExternalMove move{from.external, to.external, 0, 0};
  const StationPath way(stations.world(), cell.home, options.leave.swept_resolution);
  const std::optional<Interference> blocked = way.Between(move.from, move.to);
  LinkMove gap;
  if (out.planned && in.planned && !blocked) {
    gap = ByWayOfHome(out, in);
    move.at = static_cast<int>(out.joints.size()) - 1;
    move.duration = MoveDuration(move, cell.external_axes, options.speed_share);
    gap.duration += move.duration;
    gap.external = std::move(move);
  } else if (!out.planned || !in.planned) {
    gap.detail = out.planned ? in.detail : out.detail;
  } else {
    gap.detail = fmt::format("external axes from {} to {}: {}", PositionText(cell.external_axes, move.from),
                             PositionText(cell.external_axes, move.to), NearText(*blocked));
  }
  gap.from_pass = from.pass, gap.from_piece = from.piece;
  gap.to_pass = to.pass, gap.to_piece = to.piece;
  gap.X_WT_retracted = out.X_WT_retracted;
  gap.X_WT_approach = in.X_WT_approach;
  gap.poses_checked = out.poses_checked + in.poses_checked;
  return gap;
}

}  // namespace millpose
