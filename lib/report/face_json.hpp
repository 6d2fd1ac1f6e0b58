// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "report/face_report.hpp"

namespace millpose {

/// The figures of both faces; the same in summary.json (`face`) and in what `millpose face --json` prints.
nlohmann::ordered_json FaceReportJson(const FaceReport& report);

}  // namespace millpose
