// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements of deflections under load, as `millpose identify` reads them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "job/config/cell_settings.hpp"

namespace millpose {

struct MeasurementSettings {
  Vector6 joints = Vector6::Zero();                           ///< rad
  Eigen::Vector3d force = Eigen::Vector3d::Zero();            ///< N, in B
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();           ///< N·mm, in B
  std::optional<Eigen::Vector3d> load_point, measured_point;  ///< in F, mm
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();     ///< mm, in B
  std::optional<Eigen::Vector3d> rotation;                    ///< rad, in B
  int line = 0;
};

/// Readings of a dial in one pose that a joint has come to both ways, or with the tool pushed both ways.
struct TwoWaySettings {
  int joint = 0;                                         ///< 1 to 6
  Vector6 joints = Vector6::Zero();                      ///< rad
  std::optional<Eigen::Vector3d> measured_point;         ///< in F, mm
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< in which the dial counts, unit, in B
  std::vector<double> from_below, from_above;            ///< mm
  std::vector<double> pushed_against, pushed_along;      ///< mm
  std::optional<double> push;                            ///< N
};

struct MeasurementsSettings {
  std::string file;                                          ///< as given, for messages
  std::string cell_file;                                     ///< relative to the file
  Eigen::Vector3d load_point = Eigen::Vector3d::Zero();      ///< in F, mm, where a measurement names none
  Eigen::Vector3d measured_point = Eigen::Vector3d::Zero();  ///< likewise
  double displacement_deviation = 0.01;                      ///< mm
  double rotation_deviation = 1e-5;                          ///< rad
  std::vector<MeasurementSettings> measurements;
  std::vector<TwoWaySettings> two_way;          ///< for lost motion
  std::vector<MeasurementSettings> candidates;  ///< poses and loads to choose from; displacement not read
};

/// Reads the YAML form. Throws InputError as ParseCell() does.
MeasurementsSettings ParseMeasurements(std::string_view yaml, const std::string& name);

/// Reads the CSV form: columns a1_deg…a6_deg, fx_N, fy_N, fz_N, dx_mm, dy_mm, dz_mm, optionally mx_Nm, my_Nm,
/// mz_Nm and rx_rad, ry_rad, rz_rad. Cell and points are not in it.
MeasurementsSettings ParseMeasurementsCsv(std::string_view csv, const std::string& name);

/// Where a tracker saw the reflectors on the flange.
struct TrackedRow {
  Vector6 joints = Vector6::Zero();         ///< as the controller shows them, rad
  std::vector<Eigen::Vector3d> reflectors;  ///< in the tracker's frame, mm
  int line = 0;
};

/// Reads them: columns a1_deg…a6_deg, then x_mm, y_mm, z_mm of one reflector or x1_mm, y1_mm, z1_mm, x2_mm …
/// of up to four.
std::vector<TrackedRow> ParseTracked(std::string_view csv, const std::string& name);

/// A cell's YAML text with `arm.deviations` and `arm.serial`; everything else as it was. What the same arm's
/// joints do (gears, couplings) stays as well, before the couplings of `deviations`. Throws InputError
/// when a key is not written in one line, and where the cell would no longer be read.
std::string ReplaceDeviations(const std::string& cell_yaml, const std::string& name,
                              const DeviationSettings& deviations, const std::string& serial);

/// What an identification says of a cell's arm.
struct IdentifiedStiffness {
  Vector6 stiffness = Vector6::Zero();    ///< N·mm/rad
  Vector6 uncertainty = Vector6::Zero();  ///< half the width of its 95 % interval, a share
  std::string source;
};

/// A cell's YAML text with new joint stiffness, its uncertainty and, where it gives one, its source;
/// everything else as it was, comments included. Throws InputError when a key is not written in one line.
std::string ReplaceJointStiffness(const std::string& cell_yaml, const std::string& name,
                                  const IdentifiedStiffness& found);

/// The same with `stiffness.compliances` that millpose identify has found (link, diagonals; three digits), in
/// place of those of earlier times; an empty list takes these away and leaves others alone. Throws InputError
/// where something was found and the cell has compliances of other origin: they would count twice.
std::string ReplaceCompliances(const std::string& cell_yaml, const std::string& name,
                               const std::vector<ComplianceSettings>& found);

/// The same with lost motion (rad) and its source.
std::string ReplaceLostMotion(const std::string& cell_yaml, const std::string& name, const Vector6& width,
                              const std::string& source);

}  // namespace millpose
