// SPDX-License-Identifier: GPL-3.0-or-later
// What a KRL program says before its first motion besides its settings. Written and read as whole texts.
#pragma once

#include <array>

#include "program/krl/krl_options.hpp"
#include "program/post.hpp"

namespace millpose::krl {

inline constexpr int kLengthDecimals = 4;  ///< 0.00005 mm per coordinate
inline constexpr int kAngleDecimals = 6;   ///< of a degree, of axes and frames: 0.00005 mm at 3 m

}  // namespace millpose::krl

namespace millpose {

/// Data of KrlFrameCheck(), among the program's declarations.
std::string KrlDeclarations();
/// A message that stays until the operator has seen it and stops nothing.
std::string KrlNotice(const std::string& text);
/// Statements that stop the program with a message where the controller's $ROBROOT ($ERSYSROOT on a coupled
/// rail, and MACHINE_DEF[n].ROOT of a coupled table) is not the cell's.
std::string KrlFrameCheck(const KrlOptions& options);
/// $LOAD of the settings' load; empty where programs do not set it.
std::string KrlLoad(const KrlOptions& options, const PostSettings& settings);

/// What stands before the part's frame on a coupled table:
/// "EK(MACHINE_DEF[2].ROOT,MACHINE_DEF[2].MECH_TYPE,".
std::string KrlTableBase(const KrlTable& table);

/// How many lines from `first` on are those of `text`, apart from case and blanks, with blank lines between;
/// 0 when they are not.
size_t KrlLines(const std::string& text, const std::vector<std::string_view>& lines, size_t first);

/// The words of a frame: "X 1", "Y 2.5", "Z 3", "A 0", "B 90", "C 0.0001", angles with at most `decimals`.
std::array<std::string, 6> KrlWords(const Pose& pose, int decimals);
/// They with commas between.
std::string KrlFields(const Pose& pose, int decimals);

}  // namespace millpose
