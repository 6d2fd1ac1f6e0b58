// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/section_tracker.hpp"

namespace millpose {
namespace {

// What each state cuts: whether anything, and in which lines.
struct Cuts {
  bool any = false;
  int first_line = 0, last_line = 0;
  void Add(int line) {
    first_line = any ? std::min(first_line, line) : line;
    last_line = std::max(last_line, line);
    any = true;
  }
};

bool IsCut(const CamPath& path, size_t i) { return i > 0 && !path.points[i].rapid && !path.points[i].fresh; }

}  // namespace

void SectionTracker::ChangeTool() {
  now_.changed = now_.section.tool;
  changes_by_m6_ = true;
}

void SectionTracker::NameOperationTool(const std::string& name) {
  if (name == now_.name) return;
  now_.name = name;
  now_.section.tool.clear();
}

void SectionTracker::SetCutter(double diameter, double corner_radius) {
  now_.section.diameter = diameter;
  now_.section.corner_radius = corner_radius;
}

CamSection SectionTracker::SectionOf(const State& state,
                                     const std::map<std::string, CamCutter>& cutters) const {
  CamSection section = state.section;
  if (changes_by_m6_) section.tool = state.changed;
  if (const auto found = cutters.find(section.tool); found != cutters.end() && !section.diameter) {
    section.diameter = found->second.diameter;
    section.corner_radius = found->second.corner_radius;
  }
  if (!state.name.empty()) section.tool += (section.tool.empty() ? "" : " ") + state.name;
  return section;
}

void SectionTracker::Finish(const std::map<std::string, CamCutter>& cutters, CamPath& path) {
  std::vector<Cuts> cuts(states_.size());
  for (size_t i = 0; i < path.points.size(); ++i)
    if (IsCut(path, i)) cuts[path.points[i].section].Add(path.points[i].line);
  for (const CamHole& hole : path.holes_left_out) cuts[hole.section].Add(hole.line);
  std::vector<CamSection>& sections = path.source.sections;
  sections.clear();
  std::vector<size_t> section_of(states_.size(), 0);
  size_t unused = 0;  // states before this one that cut nothing: their rapids lead to the next cut
  for (size_t k = 0; k < states_.size(); ++k) {
    if (!cuts[k].any) continue;
    CamSection section = SectionOf(states_[k], cutters);
    if (sections.empty() || !sections.back().SameAs(section)) {
      section.first_line = cuts[k].first_line;
      sections.push_back(std::move(section));
    }
    sections.back().last_line = cuts[k].last_line;
    for (; unused <= k; ++unused) section_of[unused] = sections.size() - 1;
  }
  for (; unused < states_.size(); ++unused) section_of[unused] = sections.empty() ? 0 : sections.size() - 1;
  for (CamPoint& point : path.points) point.section = section_of[point.section];
  for (CamHole& hole : path.holes_left_out) hole.section = section_of[hole.section];
}

CamPath TakeSection(const CamPath& path, size_t section) {
  CamPath taken = path;
  taken.points.clear();
  for (size_t i = 0; i < path.points.size(); ++i) {
    const CamPoint& point = path.points[i];
    if (point.section != section) continue;
    const bool cuts_on = taken.points.empty() && IsCut(path, i);
    if (cuts_on) {  // from where the section before ended
      taken.points.push_back(path.points[i - 1]);
      taken.points.back().rapid = true;
    }
    taken.points.push_back(point);
  }
  std::erase_if(taken.holes_left_out, [&](const CamHole& hole) { return hole.section != section; });
  taken.source.sections = {path.source.sections[section]};
  return taken;
}

}  // namespace millpose
