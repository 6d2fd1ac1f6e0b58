// SPDX-License-Identifier: GPL-3.0-or-later
// How a program is cut into files: only behind a retract, where the tool is free and stands.
#pragma once

#include <functional>

#include "program/post.hpp"

namespace millpose {

/// What a post writes while Walk() goes through a program.
struct SectionWriter {
  std::function<void()> begin;  ///< a section begins: modal settings are to be stated again
  std::function<void(const ProgramEvent&)> event;
  std::function<void(size_t)> motion;  ///< index into motions
};

/// Goes through motions and events in order. Sections end behind each kPassEnd; the last one, which may be
/// empty, holds what follows the last pass. Every section but the last is one piece with the way to it, so a
/// program can be entered at each.
void Walk(const MotionProgram& program, const SectionWriter& writer);

/// One section as written.
struct Section {
  std::string text;
  int motions = 0;
};

/// Sections packed into as few files as hold at most `max_motions` and `max_bytes` each, in order; a section
/// that is larger by itself has a file of its own. The last section belongs to the main program and is left
/// out. Empty when all sections together fit into one file: then nothing need be split.
std::vector<std::string> Pack(const std::vector<Section>& sections, int max_motions, size_t max_bytes);

/// "NAME_001": the name of sub-program `index` (from 0), at most `longest` characters.
std::string SubprogramName(const std::string& name, size_t index, size_t longest);

}  // namespace millpose
