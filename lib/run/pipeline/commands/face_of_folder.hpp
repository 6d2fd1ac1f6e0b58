// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose face`: the face that a plan in its folder will leave.
#pragma once

#include <filesystem>

#include "base/file_root.hpp"
#include "run/pipeline/outputs/predict_face.hpp"

namespace millpose {

struct FaceArguments {
  std::filesystem::path plan;                ///< output folder of the plan
  std::optional<std::filesystem::path> job;  ///< of it, where it does not stand beside the folder
  FaceOptions options;  ///< without a rotation: the best fixed one of the job, as its summary names it
  FileRoot root{};
};

/// Throws InputError for what cannot be read and for what PredictFace refuses; Interrupted.
FaceReport FaceOfFolder(const FaceArguments& arguments, const Execution& execution);

}  // namespace millpose
