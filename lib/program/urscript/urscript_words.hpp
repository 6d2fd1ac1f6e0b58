// SPDX-License-Identifier: GPL-3.0-or-later
// Words of URScript as its reader takes them. The language tells capitals from small letters.
#pragma once

#include <map>

#include "machine/robot/arm.hpp"
#include "program/scanner.hpp"

namespace millpose::urscript {

/// Takes `word`, written exactly so.
bool Word(LineScanner& scan, std::string_view word);
/// Digits with at most one point and a minus before them.
double ReadNumber(LineScanner& scan);
int ReadWhole(LineScanner& scan, int least, int most);
/// True or False.
bool ReadTruth(LineScanner& scan);
/// What stands between two ".
std::string ReadString(LineScanner& scan);
/// "[1, 2, 3]": `count` numbers.
std::vector<double> ReadList(LineScanner& scan, size_t count);
/// "p[x, y, z, rx, ry, rz]", m and rad: the pose, mm.
Pose ReadPose(LineScanner& scan);
/// ", a=1, v=2": numbers by names, each of `allowed` once at most.
std::map<std::string, double> ReadNamed(LineScanner& scan, const std::vector<std::string>& allowed);
/// What stands in the brackets of popup(): a text, title, warning, error, blocking; returns whether the
/// program stands still until somebody goes on.
bool ReadPopup(LineScanner& scan);

/// A statement that texts of a cell alone may hold: outputs, waits for inputs. `loops`: how many `while` are
/// open.
bool ReadTextStatement(LineScanner& scan, int& loops);

}  // namespace millpose::urscript
