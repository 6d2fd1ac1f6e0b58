// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

namespace millpose::test {

struct VtpArrays {
  std::map<std::string, std::vector<double>> values;  ///< by "PointData/mu"
  std::map<std::string, std::string> attributes;      ///< of <Piece>
};

/// path.vtp read by a small parser of its own: tags, attributes, base64, blocks of zlib.
VtpArrays ReadVtp(const std::string& xml);

}  // namespace millpose::test
