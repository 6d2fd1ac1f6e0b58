// SPDX-License-Identifier: GPL-3.0-or-later
// What was asked of a world: enough to tell, when a body that stands still is moved, that no answer changes.
#pragma once

#include <array>
#include <mutex>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "machine/robot/arm.hpp"

namespace millpose {

/// In what boxes are measured: steps that hardly widen them, and leave few digits to keep.
inline constexpr double kBoxAngle = 1.0 / 4096, kBoxLength = 1.0 / 16;  // rad, mm

/// Poses that lie together, joint by joint, in steps of kBoxAngle (rad). Of a body that stood still it made
/// no difference how far it was, if only farther than `reach` (steps of kBoxLength, mm) from the arm at each
/// of them, and all the way where the arm moved between them.
struct PoseBox {
  std::array<int32_t, 6> low{}, width{};
  int32_t reach = 0;
};

/// Everything that was asked.
struct Queries {
  std::vector<PoseBox> boxes;
  std::vector<std::string> met;  ///< bodies that stand still and that an answer told of
};

/// Collects what is asked, from several threads: what lies within a degree or a few is put together.
class QueryLog {
 public:
  /// The poses between `low` and `high`, rad.
  void Add(const Joints& low, const Joints& high, double reach);
  /// Those on the straight way from q0 to q1, each joint up to `beside` next to it.
  void AddMotion(const Joints& q0, const Joints& q1, const Joints& beside, double reach);
  void Meet(const std::string& body) { met_.insert(body); }
  /// Adds what another has collected; may be called from several threads.
  void Take(const QueryLog& other);
  /// The same of what was collected before.
  void Take(const Queries& earlier);

  Queries Collected() const;

 private:
  using Place = std::array<int16_t, 6>;
  struct Hash {
    size_t operator()(const Place& place) const;
  };
  void Widen(const Place& place, const PoseBox& box);

  std::unordered_map<Place, PoseBox, Hash> boxes_;
  std::set<std::string> met_;
  std::mutex mutex_;
};

}  // namespace millpose
