// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose check`: reads everything, reaches every point, plans nothing.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "base/file_root.hpp"
#include "base/progress.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/mesh_parts.hpp"
#include "job/arrival.hpp"
#include "job/config/config.hpp"
#include "job/inputs.hpp"
#include "job/measured_arm.hpp"
#include "machine/robot/mechanism.hpp"
#include "report/words/words.hpp"
#include "run/pipeline/commands/advise.hpp"
#include "toolpath/cam/cam_source.hpp"

namespace millpose {

/// The page beside a check, see docs/check.md; written when it has a name.
struct PageTarget {
  std::filesystem::path file;
  Language language = Language::kEnglish;
};
using ViewFile = std::optional<PageTarget>;

/// What can be said about a mesh.
struct MeshCheck {
  std::string file;
  ImportReport report;
  double median_bend = 0;  ///< of edges that are neither flat (below 0.1°) nor creases, rad; 0 without any
  size_t creases = 0;      ///< edges that bend by more than 30°
  double unit = 1;         ///< mm per unit of the file, as taken
  bool unit_plausible = true;  ///< for the arm; else a warning names the units that would be
  /// A face of a STEP part in its order, or of a mesh: what hangs together over edges that bend by at most
  /// 30°.
  struct Face {
    size_t number = 0;    ///< as check's page and, of a STEP part, step_faces count
    SourceFace source{};  ///< of a mesh without id, name and kind
    FacePart part;
  };
  std::vector<Face> faces;  ///< of a mesh the largest ones
  bool from_step = false;
  /// Round holes of one diameter.
  struct Holes {
    double diameter = 0;                      ///< mm
    size_t blind = 0, through = 0, rims = 0;  ///< walls with one and two open ends; rims of a sheet
  };
  std::vector<Holes> holes;  ///< by rising diameter
  std::vector<std::string> warnings;
  std::vector<std::string> notes;  ///< how a CAM path was read; no findings
};

struct CheckMeshArguments {
  std::filesystem::path mesh;
  std::optional<double> unit;     ///< mm per unit of the file; by default what the file states, else 1
  double weld_tolerance = 1e-4;   ///< mm
  double chord_tolerance = 0.05;  ///< mm, of a STEP part
  FileRoot root{};                ///< that the file must lie in
  ViewFile view{};
};

/// Throws InputError for what cannot be read; Interrupted.
MeshCheck CheckMesh(const CheckMeshArguments& arguments, Progress& progress = Silent(),
                    std::stop_token stop = {});

/// A job's part and tool path against its arm.
struct JobCheck {
  MeshCheck mesh;
  std::string job, cell, arm;
  std::string operation;     ///< of a job with several; else empty
  std::string for_arm = {};  ///< serial and date, where the programs are for that arm alone; else empty
  size_t passes = 0, points = 0;
  /// Points by the best that any rotation about the tool axis and any branch gives: admissible, unreachable,
  /// outside the limits, near a singularity. Interference is not looked at.
  std::array<size_t, 4> reach{};
  std::array<size_t, 6> limited{};  ///< points outside the limits by the axis that is farthest beyond its own
  std::vector<size_t> out_of_reach;  ///< numbers of the first points that are not admissible
  std::optional<CamSource> source;   ///< of a CAM path: who wrote it, and how it was taken
  size_t gouges = 0;         ///< points where the cutter would go into the part beyond the job's tolerance
  double deepest_gouge = 0;  ///< mm
  Eigen::Vector3d gouge_place = Eigen::Vector3d::Zero();  ///< in P
  std::optional<OperationAdvice> advice{};                ///< where it was asked for
  CutsOfTool cuts{};  ///< what the path takes off a raw part, but for points out of reach; in P
};

/// A cell by itself.
struct CellCheck {
  std::string cell, arm;
  size_t bodies = 0;
  double reach = 0;                         ///< mm, from axis 1 to the tool's tip
  std::vector<std::string> controllers;     ///< for which programs can be written
  std::vector<ExternalAxis> external_axes;  ///< rails, lifts and tables, in their order
  ArmArrival arrival;
  MeasuredArm measured;
  std::vector<std::string> warnings;
};

struct CheckCellArguments {
  std::filesystem::path cell;
  FileRoot root{};  ///< that all files must lie in
  ViewFile view{};
};

/// Throws InputError for what cannot be read.
CellCheck CheckCell(const CheckCellArguments& arguments);

/// Whether a YAML file says that it is a cell.
bool IsCellFile(const std::filesystem::path& file, const FileRoot& root);

struct CheckJobArguments {
  int threads = 0;  ///< 0: all cores
  double max_points = 2e6;
  ViewFile view{};
  std::vector<Override> overrides{};  ///< settings in place of the job's
};

/// Everything that `plan` refuses or warns of before it plans, told as `plan` tells it. Throws InputError for
/// what cannot be planned; Interrupted.
JobCheck CheckJob(JobInputs inputs, const CheckJobArguments& arguments, Progress& progress,
                  std::stop_token stop);

/// For people, and as JSON (keys name their units).
std::string ToText(const MeshCheck& check);
std::string ToText(const JobCheck& check);
std::string ToText(const CellCheck& check);
std::string ToJson(const MeshCheck& check);
std::string ToJson(const JobCheck& check);
std::string ToJson(const std::vector<JobCheck>& operations);
std::string ToJson(const CellCheck& check);

/// Whether anything was found that a user should look at (exit status 1).
bool HasFindings(const MeshCheck& check);
bool HasFindings(const JobCheck& check);
bool HasFindings(const CellCheck& check);

}  // namespace millpose
