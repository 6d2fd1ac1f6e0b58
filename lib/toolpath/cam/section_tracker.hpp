// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// What a CAM file says of tool and spindle while it is read; makes the path's sections of it.
class SectionTracker {
 public:
  /// A tool is named. In G-code it may be the next one, which M6 changes to later on.
  void NameTool(const std::string& tool) { now_.section.tool = tool; }
  /// M6: the tool that was named last is in the spindle from now on.
  void ChangeTool();
  bool changes_by_m6() const { return changes_by_m6_; }
  /// TOOL PATH of NX: its tool's name; a new one has no number yet.
  void NameOperationTool(const std::string& name);
  void SetCutter(double diameter, double corner_radius);
  void SetSpeed(std::optional<double> speed) { now_.section.speed = speed; }
  void SetSense(SpindleSense sense) { now_.section.sense = sense; }
  /// Stamps the point or hole that was appended last.
  template <class Item>
  void Stamp(Item& item) {
    if (states_.empty() || !Same(states_.back(), now_)) states_.push_back(now_);
    item.section = states_.size() - 1;
  }
  /// Makes sections of the stamps: only cuts and holes count, a rapid belongs to what comes next. `cutters`
  /// by tool, for those that comments name.
  void Finish(const std::map<std::string, CamCutter>& cutters, CamPath& path);

 private:
  struct State {
    CamSection section;
    std::string name, changed;  // of the operation's tool; by M6
  };
  static bool Same(const State& a, const State& b) {
    return a.section.SameAs(b.section) && a.name == b.name && a.changed == b.changed;
  }
  CamSection SectionOf(const State& state, const std::map<std::string, CamCutter>& cutters) const;

  State now_;
  std::vector<State> states_;
  bool changes_by_m6_ = false;
};

}  // namespace millpose
