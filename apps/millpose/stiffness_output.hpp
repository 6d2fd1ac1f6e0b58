// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "machine/stiffness/pose_stiffness.hpp"
#include "planning/pose/map.hpp"

namespace millpose {

/// One evaluated pose, for output. Everything in B.
struct PoseReport {
  Joints q;
  Eigen::Vector3d normal;
  std::string origin;  ///< tool_tip | flange
  PoseStiffness stiffness;
  std::optional<Eigen::Vector3d> weight;  ///< deflection by weight against the calibration pose, mm
  bool counterbalance_ignored = false;    ///< the cell gives none
};

std::string ReportAsText(const PoseReport& report);
std::string ReportAsJson(const PoseReport& report);
std::string ReportsAsJson(const std::vector<PoseReport>& reports);
std::string ReportsAsCsv(const std::vector<PoseReport>& reports);
std::string MapAsJson(const MapRequest& request, const std::vector<MapPoint>& points);
std::string MapSummary(const MapRequest& request, const std::vector<MapPoint>& points);

}  // namespace millpose
