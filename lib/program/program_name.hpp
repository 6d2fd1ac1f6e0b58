// SPDX-License-Identifier: GPL-3.0-or-later
// Names that controllers know programs by: short, of few characters, and still those of one job alone.
#pragma once

#include <string>

namespace millpose {

/// Characters of a program's name where controllers hold 24: sub-programs take four more.
inline constexpr size_t kProgramNameLength = 20;

/// Five lower-case letters and digits that tell `text` from others, the same on every machine.
std::string NameHash(const std::string& text);

/// `text` as a program name: ASCII letters, digits and '_', in at most `longest` characters, beginning with a
/// letter (`letters` of them); other characters become '_'. One that is longer is cut and ends in '_' and
/// NameHash() of the whole text. Precondition: longest is 10 or more.
std::string LegalName(const std::string& text, size_t longest, size_t letters);

/// The name of an operation's program: what the operation is called, '_' and NameHash() of job and operation,
/// so that no other job's operation has it; legal for every controller.
std::string OperationName(const std::string& job, const std::string& operation);

/// "NAME_001": the name of sub-program `index` (from 0), at most `longest` characters.
std::string SubprogramName(const std::string& name, size_t index, size_t longest);

/// "NAME_P3_1": the program that starts piece `piece` of pass `pass` by itself, legal for every controller.
std::string StartName(const std::string& job, int pass, int piece);

/// A name as controllers tell it from others: without capitals.
std::string AsTold(std::string name);

/// The program that one of this name would be a sub-program or a start of, as AsTold(): "panel" of
/// "panel_001" and of "Panel_P3_1"; empty where it could be of none.
std::string WithoutPart(const std::string& name);

/// Whether programs can hold a tool's name: in texts in quotes, in comments of every controller, and in tool
/// tables, which take 32 characters.
bool IsToolName(const std::string& name);

}  // namespace millpose
