// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/entries.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kAbove = 0.05;   // mm over the tip: below this a cutter only touches
constexpr double kMiddle = 0.25;  // of its radius: where a cutter without a centre edge cuts nothing
constexpr int kProbesAroundMiddle = 6;

}  // namespace

std::vector<char> MeetsMaterial(const EngagementOptions& options, const Toolpath& toolpath,
                                const std::vector<size_t>& entries) {
  assert(!options.stated);
  std::vector<const MillingPoint*> points;
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points) points.push_back(&point);
  const SweptPath swept(options.edge.cutter, toolpath);
  std::vector<char> meets;
  for (const size_t number : entries) {
    const MillingPoint& point = *points.at(number);
    SweptPath::Near before;  // without what the cutter clears by standing at the point itself
    if (number > 0) before = swept.Before(number - 1, point.position, point.normal);
    const auto stands = [&](const Vector3d& place) {
      return options.stock(place) && !swept.Removed(before, place);
    };
    const Vector3d middle = point.position + kAbove * point.tool_axis;
    const Vector3d across = point.tool_axis.unitOrthogonal(), beside = point.tool_axis.cross(across);
    bool meets_any = stands(middle);
    for (int i = 0; i < kProbesAroundMiddle && !meets_any; ++i) {
      const auto [s, c] = SinCos(2 * kPi * i / kProbesAroundMiddle);
      meets_any = stands(middle + kMiddle * options.edge.cutter.radius * (c * across + s * beside));
    }
    meets.push_back(meets_any);
  }
  return meets;
}

}  // namespace millpose
