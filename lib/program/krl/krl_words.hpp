// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of KRL statements: aggregates, outputs, conditions.
#pragma once

#include <map>

#include "program/motion_program.hpp"
#include "program/scanner.hpp"

namespace millpose::krl {

using Fields = std::map<std::string, double>;

/// {X 1,Y 2,…} or {FRAME: X 1,…}, with one of `types` before the colon: the fields by name in upper case, of
/// those `allowed`.
Fields ReadFields(LineScanner& scan, const std::vector<std::string>& types,
                  const std::vector<std::string>& allowed);
/// Fails where one of `names` is missing.
void ExpectAll(LineScanner& scan, const Fields& fields, const std::vector<std::string>& names);
/// Of X, Y, Z (mm), A, B, C (degrees).
Pose PoseOf(const Fields& fields);

/// {FRAME: X 1,Y 2,Z 3,A 4,B 5,C 6}, all of them.
Pose ReadFrame(LineScanner& scan);
/// "= EK(MACHINE_DEF[2].ROOT,MACHINE_DEF[2].MECH_TYPE,{X 1,…})" with the number `machine_def`: the frame.
Pose ReadTableBase(LineScanner& scan, int machine_def);

/// 0.5: above 0; and "= 0.5".
double ReadAboveZero(LineScanner& scan);
double ReadPositive(LineScanner& scan);
/// A whole number from `least` to `most`.
int ReadWhole(LineScanner& scan, int least, int most);
bool ReadTruth(LineScanner& scan);

/// DISTANCE=0 DELAY=0 DO $OUT[3]=TRUE: switched at the start of the next motion. TRIGGER WHEN is taken.
PathOutput ReadTrigger(LineScanner& scan);

/// $OUT[3]=TRUE, $ANOUT[1]=0.5, PULSE($OUT[3],TRUE,0.5): what a text of the cell may switch; false when
/// another statement comes next.
bool ReadOutput(LineScanner& scan);

/// The condition of WAIT FOR: inputs, outputs and flags by number, joined by NOT, AND, OR, EXOR and brackets.
/// Anything else, a function of the plant among it, may do more than wait.
void ReadCondition(LineScanner& scan);

}  // namespace millpose::krl
