// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/causes.hpp"

#include <map>

#include "base/error.hpp"

namespace millpose {
namespace {

struct Words {
  const char *one, *many;  // what is wrong, once and several times
  const char* cure;
};

const Words& WordsOf(Cause cause) {
  static const std::map<Cause, Words> words = {
      {Cause::kOther, {"other finding", "other findings", "see the findings themselves"}},
      {Cause::kText,
       {"line that its own reader refuses", "lines that its own reader refuses",
        "look at `controllers.{0}.texts` and the numbers of `controllers.{0}.outputs` in the cell"}},
      {Cause::kPath,
       {"place where the tool leaves the planned path", "places where the tool leaves the planned path",
        "smaller `program_options.point_economy.angle_deg` and `chord_mm`, a larger "
        "`program_options.path_tolerance_mm`, or a smaller `path.max_joint_deg_per_mm`"}},
      {Cause::kFeed,
       {"motion whose feed is not the planned one", "motions whose feed is not the planned one",
        "a lower `process.feed_mm_min`; KRL: a larger `controllers.krl.orientation_speed_deg_s`"}},
      {Cause::kJointSpeed,
       {"motion faster than a joint can turn", "motions faster than a joint can turn",
        "`process.feed: reduce` (the default), or a lower `process.feed_mm_min`"}},
      {Cause::kCorner,
       {"corner rounded by too much, or passed too fast", "corners rounded by too much, or passed too fast",
        "a larger `program_options.path_tolerance_mm` and `path_tolerance_deg`; where the maker documents no "
        "corner, a larger `controllers.{0}.max_corner_mm`"}},
      {Cause::kStop,
       {"stop of the tool in the cut", "stops of the tool in the cut",
        "larger `controllers.{0}.max_motions` and `max_kbytes`"}},
      {Cause::kReach,
       {"motion that the arm cannot make", "motions that the arm cannot make",
        "a larger `limits.margin_deg` or `limits.singularity_min`"}},
      {Cause::kWay,
       {"way between cuts that is not the planned one", "ways between cuts that are not the planned ones",
        "none of the job's keys: the home position or a text of the cell is in the way"}},
      {Cause::kInterference,
       {"motion that comes too near to something", "motions that come too near to something",
        "larger clearances in the cell, or a smaller `interference.swept_resolution_mm`"}},
      {Cause::kSwitching,
       {"difference in what is switched", "differences in what is switched",
        "look at `controllers.{0}.outputs` and `controllers.{0}.texts` in the cell"}},
  };
  return words.at(cause);
}

}  // namespace

std::vector<CauseGroup> GroupByCause(const std::vector<Finding>& findings) {
  std::vector<CauseGroup> groups;
  for (const Finding& finding : findings) {
    auto group = std::ranges::find(groups, finding.cause, &CauseGroup::cause);
    if (group == groups.end()) group = groups.insert(groups.end(), {finding.cause, 0, finding});
    group->count += finding.count;
  }
  std::ranges::stable_sort(groups, std::ranges::greater{}, &CauseGroup::count);
  return groups;
}

std::string Describe(const CauseGroup& group) {
  const Words& words = WordsOf(group.cause);
  return fmt::format("{} {}", group.count, group.count == 1 ? words.one : words.many);
}

std::string Cure(Cause cause, const std::string& controller) {
  return fmt::format(fmt::runtime(WordsOf(cause).cure), controller);
}

}  // namespace millpose
