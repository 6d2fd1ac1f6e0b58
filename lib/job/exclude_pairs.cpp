// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/exclude_pairs.hpp"

#include "base/random.hpp"
#include "job/assemble.hpp"
#include "machine/collision/world.hpp"

namespace millpose {
namespace {

constexpr int kPoses = 200;

// Which joint moves the body last: 0 to 6; empty where it is not on the robot.
std::optional<int> JointOf(const Body& body) {
  if (body.mount == Mount::kTool) return 6;
  if (body.mount == Mount::kLink) return body.link;
  return std::nullopt;
}

Joints RandomPose(const Arm& arm, RandomStream& random) {
  Joints q;
  for (Eigen::Index i = 0; i < 6; ++i) q[i] = random.Uniform(arm.lower[i], arm.upper[i]);
  return q;
}

// Whether the two touch in every sampled pose; most pairs are free in the first.
bool AlwaysTouch(const Cell& empty, const Body& a, const Body& b) {
  Cell two = empty;
  two.bodies = {a, b};
  const World world(std::move(two));
  Checker checker(world);
  RandomStream random(1, 0);
  for (int k = 0; k < kPoses; ++k)
    if (!checker.At(RandomPose(empty.arm, random), Phase::kFree)) return false;
  return true;
}

bool IsExcluded(const Cell& cell, const Body& a, const Body& b) {
  return std::ranges::any_of(cell.excluded_pairs, [&](const auto& pair) {
    return pair == std::pair(a.name, b.name) || pair == std::pair(b.name, a.name);
  });
}

}  // namespace

void ExcludeTouchingNeighbours(const std::map<std::string, std::string>& body_bytes, bool from_urdf,
                               CellSettings* settings) {
  if (!from_urdf && !settings->auto_excluded_pairs) return;
  const Cell cell = MakeCell(*settings, body_bytes);
  Cell empty = cell;
  empty.bodies.clear();
  empty.excluded_pairs.clear();
  empty.clearances = {0, 0};
  std::vector<std::pair<std::string, std::string>> found;
  for (size_t i = 0; i < cell.bodies.size(); ++i)
    for (size_t j = i + 1; j < cell.bodies.size(); ++j) {
      const Body &a = cell.bodies[i], &b = cell.bodies[j];
      const auto on_a = JointOf(a), on_b = JointOf(b);
      if (!on_a || !on_b || on_a == on_b || std::abs(*on_a - *on_b) > 2 || IsExcluded(cell, a, b)) continue;
      if (AlwaysTouch(empty, a, b)) found.emplace_back(a.name, b.name);
    }
  if (std::exchange(settings->auto_excluded_pairs, false)) {
    settings->excluded_pairs.insert(settings->excluded_pairs.end(), found.begin(), found.end());
    return;
  }
  for (const auto& [a, b] : found)
    settings->warnings.push_back(fmt::format(
        "{}: '{}' and '{}' touch in each of {} poses: no pose will be free of interference. If they meet by "
        "design, add excluded_pairs: [[{}, {}]], or auto_excluded_pairs: true for all such pairs",
        settings->file, a, b, kPoses, a, b));
}

}  // namespace millpose
