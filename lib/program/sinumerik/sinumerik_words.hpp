// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of SINUMERIK statements that stand in a block of their own.
#pragma once

#include <optional>

#include "machine/robot/arm.hpp"
#include "program/motion_program.hpp"
#include "program/scanner.hpp"

namespace millpose::sinumerik {

/// Of what the compressor may leave; none: the machine's.
struct Tolerances {
  std::optional<double> position, orientation;  ///< mm, rad
};

/// CYCLE832(0.01,_ORI_FINISH,0.01): mm and degrees. With _FINISH the third value counts for nothing: the
/// orientation's tolerance is then a setting datum's (SD55443); with _OFF both are the machine's. Which
/// compressor and which rounding the cycle switches on is the machine's CUST_832.
Tolerances ReadTolerances(LineScanner& scan);

/// "$A_OUT[3]=1" of a synchronised action.
PathOutput ReadOutput(LineScanner& scan);

/// "CTRANS(X,1,Y,2,Z,3):CROT(X,0,Y,0,Z,90)", mm and degrees: the frame.
Pose ReadFrame(LineScanner& scan);

}  // namespace millpose::sinumerik
