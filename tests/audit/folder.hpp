// SPDX-License-Identifier: GPL-3.0-or-later
// What the judge reads of a plan's output folder. Nothing here is shared with the planner's own modules:
// formats are read anew, so that a mistake there is not repeated here.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "judge/setup.hpp"

namespace millpose::audit {

/// One row of points.csv; a skipped point has no angles.
struct Row {
  int point, pass, piece;
  bool planned;
  Vector3 position, normal, axis;  ///< in W, mm
  Angles angles;                   ///< rad
  Real lambda_t1, lambda_t2, lambda_n, mu, dexterity, objective;
  Real feed;  ///< mm/s
};

/// A planned way between two pieces, from plan.cbor; pass −1 is home.
struct PlannedGap {
  int from_pass, from_piece, to_pass, to_piece;
  std::vector<Angles> joints;  ///< from the retracted tool to where the approach begins
};

/// A folder as read.
struct Folder {
  Setup setup;
  std::vector<Row> rows;
  std::vector<PlannedGap> gaps;
  std::map<std::string, std::map<std::string, std::string>> programs;  ///< controller → file name → text
};

/// Reads `path`. Cell and mesh are named in job.yaml relative to where the job was: `inputs`, else the folder
/// itself or the one that it lies in. Throws an exception that says what is missing or malformed.
Folder ReadFolder(const std::filesystem::path& path, const std::filesystem::path& inputs = {});

/// The cell and job that `job` (the bytes of a resolved job.yaml) names, in the first of `starts` where they
/// are. `resolved`: bytes of the cell.yaml of an output folder, which a cell with a URDF needs.
Setup ReadSetup(const std::string& job, const std::vector<std::filesystem::path>& starts,
                const std::string& resolved = {});

/// Parts of ReadFolder.
std::vector<PlannedGap> ReadGaps(const std::string& cbor);
UrdfArm ReadUrdf(const std::string& xml, const std::string& base, const std::string& flange);
std::vector<Row> ReadPoints(const std::string& csv);
Mesh ReadStl(const std::string& bytes, Real unit);

}  // namespace millpose::audit
