// SPDX-License-Identifier: GPL-3.0-or-later
// What the range of no single key catches: settings that are each allowed and together cannot be true of an
// arm, a tool, a part or a cut. One table, which check, init and plan share (docs/check.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "job/inputs.hpp"
#include "machine/collision/cell.hpp"
#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// One thing that is hardly meant.
struct Doubt {
  std::string key;       ///< path of the key that is most likely wrong: "process.feed_mm_min"
  bool of_cell = false;  ///< the key is the cell's, else the job's
  std::string text;      ///< the value, and what would be usual
  bool refused = false;  ///< nothing is planned with it
};

/// What the table looks at; what is not given is not judged.
struct Judged {
  const CellSettings& settings;
  const Cell& cell;  ///< MakeCell() of the settings
  const JobSettings* job = nullptr;
  std::optional<Eigen::Vector3d> part = {};   ///< its extent along x, y, z, mm
  std::optional<CuttingForce> heaviest = {};  ///< of all cuts, N
};

/// Every row of the table that does not hold.
std::vector<Doubt> DoubtsOf(const Judged& judged);

/// The doubts as sentences "file:line:column: key: value; usual: …". Throws InputError with those that are
/// refused.
std::vector<std::string> TellDoubts(const std::vector<Doubt>& doubts, const JobInputs& inputs);
/// The same of a cell by itself.
std::vector<std::string> TellDoubts(const std::vector<Doubt>& doubts, const CellSettings& cell);

}  // namespace millpose
