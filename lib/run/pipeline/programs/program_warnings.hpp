// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"
#include "report/report.hpp"
#include "run/pipeline/programs/program_motions.hpp"

namespace millpose {

/// What the controller is estimated to make of the feeds; `wanted` as EstimateSpeed() has it.
PathSpeed EstimatePathSpeed(const MotionProgram& written, const std::string& controller,
                            const PathDynamics& dynamics, double wanted);

/// A sentence that names the slowest points and what helps; empty where the feed is held.
std::string SpeedWarning(const PathSpeed& speed);

/// Bytes that all files of a program take together.
size_t BytesOf(const ProgramFiles& files);

/// A sentence where the files together exceed `memory`, the bytes that the controller has for programs (0: no
/// such bound), with what helps; else empty.
std::string MemoryWarning(const ProgramFiles& files, size_t memory);

}  // namespace millpose
