// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/sections.hpp"

namespace millpose {

void Walk(const MotionProgram& program, const SectionWriter& writer) {
  writer.begin();
  size_t event = 0;
  for (size_t i = 0; i <= program.motions.size(); ++i) {
    for (; event < program.events.size() && program.events[event].before_motion == i; ++event) {
      writer.event(program.events[event]);
      if (program.events[event].kind == ProgramEvent::Kind::kPassEnd) writer.begin();
    }
    if (i < program.motions.size()) writer.motion(i);
  }
}

std::vector<std::string> Pack(const std::vector<Section>& sections, int max_motions, size_t max_bytes) {
  int all_motions = 0;
  size_t all_bytes = 0;
  for (const Section& section : sections) {
    all_motions += section.motions;
    all_bytes += section.text.size();
  }
  if (all_motions <= max_motions && all_bytes <= max_bytes) return {};
  std::vector<std::string> texts;
  int motions = 0;
  for (size_t i = 0; i + 1 < sections.size(); ++i) {
    const Section& section = sections[i];
    const bool fits = !texts.empty() && motions + section.motions <= max_motions &&
                      texts.back().size() + section.text.size() <= max_bytes;
    if (!fits) {
      texts.emplace_back();
      motions = 0;
    }
    texts.back() += section.text;
    motions += section.motions;
  }
  return texts;
}

std::string SubprogramName(const std::string& name, size_t index, size_t longest) {
  const std::string number = fmt::format("_{:03}", index + 1);
  return name.substr(0, longest - number.size()) + number;
}

}  // namespace millpose
