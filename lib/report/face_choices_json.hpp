// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planning/result/face_choice.hpp"

namespace millpose {

/// `face_choices` of summary.json; null where the job is not planned for the face.
nlohmann::ordered_json FaceChoicesJson(const std::vector<FaceChoice>& faces);

/// One line for the terminal.
std::string FaceChoicesText(const std::vector<FaceChoice>& faces);

}  // namespace millpose
