// SPDX-License-Identifier: GPL-3.0-or-later
// The face before it is milled, as people and scripts read it (docs/face.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning/face/face_study.hpp"
#include "report/words/words.hpp"

namespace millpose {

/// A plan's face, and beside it that of a fixed rotation.
struct FaceReport {
  std::string job;
  FaceRays rays;
  StatedErrors stated;
  FaceStudy plan;
  std::optional<double> rotation;  ///< rad, the fixed one; empty: there is none to compare with
  std::optional<FaceStudy> fixed;  ///< of it
  std::string fixed_in_the_way;    ///< one sentence, where it has no face
};

/// What every output says that the faces leave out.
std::vector<std::string> NotInFace(const StatedErrors& stated);

/// For the terminal and the report, in columns: words in `language`, figures and names as they are.
std::string FaceText(const FaceReport& report, Language language = Language::kEnglish);
/// Keys name their units.
std::string FaceJson(const FaceReport& report);

}  // namespace millpose
