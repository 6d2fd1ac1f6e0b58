// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of LS statements: numbers, speeds, outputs, conditions.
#pragma once

#include <optional>

#include "program/scanner.hpp"

namespace millpose::fanuc {

/// A whole number from `least` to `most`.
int ReadWhole(LineScanner& scan, int least, int most);
/// "12.5", or "(-12.5)" as negative constants are written.
double ReadConstant(LineScanner& scan);
/// "[3]" or "[3:name]": of a signal or register.
int ReadIndex(LineScanner& scan);
bool ReadOnOff(LineScanner& scan);

/// "10mm/sec" or "8cm/min", whole numbers: mm/s. A speed in a register is refused.
double ReadFeed(LineScanner& scan);
/// ".50(sec)" behind WAIT; empty where a condition comes.
std::optional<double> ReadSeconds(LineScanner& scan);
/// "DI[1]=ON AND DO[2]=OFF": signals by number, joined by AND or by OR.
void ReadCondition(LineScanner& scan);

/// DO[3]=ON, DO[3]=PULSE,0.5sec, RO[1]=OFF, GO[1]=7, AO[2]=3.5, R[4]=7000, PAYLOAD[1]: what a text of the
/// cell may do; false when another statement comes next.
bool ReadTextWord(LineScanner& scan);

}  // namespace millpose::fanuc
