// SPDX-License-Identifier: GPL-3.0-or-later
// What people and scripts read of a plan. Pure functions of their arguments; nothing here opens files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/byte_sink.hpp"
#include "planning/result/continuity.hpp"
#include "planning/result/cycle_time.hpp"
#include "planning/result/face_choice.hpp"
#include "planning/result/fixed_comparison.hpp"
#include "planning/result/plan_result.hpp"
#include "planning/result/price.hpp"
#include "planning/result/stock_figures.hpp"
#include "report/budget.hpp"
#include "report/compensation.hpp"
#include "report/deflection.hpp"
#include "report/face_report.hpp"
#include "report/lost_motion.hpp"
#include "report/registration.hpp"
#include "report/step_heights.hpp"
#include "toolpath/cutter.hpp"

namespace millpose {

/// What the maker of a controller does not document, but for which a program is confirmed: the path of its
/// rounded corners (docs/verification.md).
struct ReportedBound {
  double position = 0, angle = 0;  ///< mm, rad: by how much it may leave the programmed one
  std::string assumption;          ///< under which that is so
};

/// One program file as written and confirmed.
struct ReportedProgram {
  std::string path;  ///< relative to the output folder
  std::string controller;
  std::vector<int> motions_per_pass;
  int points_saved = 0;   ///< of the whole program: left out, the controller's own motion passes them
  int points_near = 0;    ///< of the whole program: nearer to the one before than the least spacing
  bool verified = false;  ///< and so written
  std::string withheld;   ///< why it is not
  std::optional<ReportedBound> but_for = std::nullopt;  ///< what alone it is not confirmed in
};

/// What all files of one controller's program take.
struct ProgramSize {
  std::string controller;
  size_t files = 0, bytes = 0;
  size_t memory = 0;  ///< bytes that the controller has for them; 0: no such bound
};

/// What the audit found on a pair of bodies.
struct AuditPair {
  std::string first, second;
  long long contacts = 0, too_near = 0;  ///< motions on which they touch; come nearer than is to be kept
  double least_mm = 0, wanted_mm = 0;    ///< where they come nearest, and what is to be kept there
  std::string where;                     ///< the first of these motions
};

/// Figures recomputed on request (`--audit`).
struct AuditFigures {
  double ga_share_within_0p1_percent = 0;                ///< of the points judged, %
  double ga_worst_gap_percent = 0;                       ///< genetic algorithm above the exhaustive optimum
  std::optional<double> ga_share_without_table_percent;  ///< as the share, started at random alone
  long long limit_violations = 0;                        ///< points outside the admissible limits
  long long interferences = 0;                           ///< motions on which bodies touch
  long long clearance_violations = 0;  ///< motions times pairs that come nearer than is to be kept
  std::vector<AuditPair> pairs;        ///< of both
  double max_slice_distance_mm = 0;    ///< of the cut points from the mesh
};

/// How far $BASE may be shifted together with a part whose place was measured, along and about X, Y, Z of the
/// base, to either side; 0: not at all.
struct BaseWindow {
  double shift = 0;      ///< mm
  double turn = 0;       ///< rad
  std::string obstacle;  ///< what kept it from being larger; empty when it is as large as asked
};

/// What a controller is estimated to make of the feed along the cuts (program/path_speed.hpp).
struct PathSpeed {
  struct Place {
    int pass = 0, point = 0;
    double feed = 0, speed = 0;  ///< mm/s: programmed, estimated
    std::string cause;           ///< corner | motion: a sharp corner, or a motion too short
  };
  std::string controller;
  double lowest_share = 1;  ///< of the programmed feed
  std::vector<Place> slow;  ///< where it is below 1
};

/// What a report tells beyond the plan itself.
struct ReportInputs {
  std::vector<ReportedProgram> programs;
  std::vector<ProgramSize> program_sizes;
  std::vector<std::string> warnings;  ///< repairs of the mesh, doubtful units
  std::vector<std::string> findings;  ///< what stands in the way of trust, one sentence each
  std::optional<AuditFigures> audit;
  std::optional<ContinuityFigures> continuity;
  FeedReduction feed_reduction;
  std::vector<ControllerTime> times;  ///< of every program
  std::vector<PathSpeed> path_speeds;
  std::optional<BaseWindow> base_window;
  std::optional<DeflectionReport> deflection;  ///< when the job says what the cutter takes off
  std::optional<CompensationFigures> compensation;
  std::optional<RegistrationFigures> registration;  ///< where `millpose register` found the part's place
  std::optional<StockFigures> stock;                ///< where the job has a raw part
  std::optional<LostMotionReport> lost_motion;      ///< of every plan
  std::optional<Budget> budget;                     ///< where a face is cut or a force is stated
  std::vector<FaceChoice> faces;                    ///< where whole ways are judged by the face
  const FixedComparison* fixed = nullptr;           ///< beside the best fixed rotation; outlives this
  std::optional<PoseSteps> steps;                   ///< when the cell says how well the tool is known
  std::optional<FaceReport> face;                   ///< when it was asked for
};

/// What differs from run to run; goes into run.json alone.
struct RunFigures {
  struct Stage {
    std::string name;
    double wall_s = 0;
  };
  double wall_s = 0;
  std::vector<Stage> stages;
  double peak_memory_MB = 0;
  int threads = 0;
  std::string host, version;
  std::string program_id;  ///< of the program's file
  size_t resumed_passes = 0, resumed_gaps = 0;
  /// The folder that the paths in job.yaml count from: absolute, and as seen from the output folder.
  struct JobFolder {
    std::string absolute, relative;
  };
  JobFolder job_folder;
  /// The job that was planned: its name, and its file as seen from the output folder.
  struct JobFile {
    std::string name, file;
  };
  JobFile job;
  std::string manifest;  ///< hash of manifest.json: whose plan this run.json belongs to
  std::string asked;     ///< of the run, beside its inputs: what results depend on
  int exit_status = 0;
  std::string told;     ///< BriefText
  std::string details;  ///< SummaryText: what `plan -v` prints in its place; empty where there is no more
};

/// Best (smallest), median and worst (largest) of one index over the planned points; empty when there is
/// none.
struct Spread {
  double best = 0, median = 0, worst = 0;
};

/// How the paper's own formulation did over the points where it ran.
struct PaperFigures {
  size_t searched = 0;
  size_t within_tolerance = 0;  ///< of eq. 26: 0.1 mm and 0.1°
  size_t usable = 0;            ///< and admissible on the exact pose
  size_t on_path = 0;           ///< and chosen by the ladder search
  Spread position_error;        ///< mm
  Spread angle_error;           ///< rad
  std::optional<Spread>
      above_exhaustive;  ///< relative, of those within the tolerance; below 0: error used up
};

/// Figures that several reports share.
struct PlanFigures {
  size_t total = 0, planned = 0, gaps_planned = 0, pieces = 0;
  std::optional<Spread> lambda_t1, lambda_t2, lambda_n, objective;  ///< mm/N; objective in its own unit
  std::optional<Price> price;                ///< what the path costs against the points' own optima
  std::optional<double> ga_nodes_share;      ///< of the path's nodes that came from the genetic algorithm
  std::optional<double> clearance_min;       ///< mm
  std::optional<double> acceleration_ratio;  ///< RMS of joint accelerations in cuts after ÷ before smoothing
  std::optional<double> smoothing_loss;      ///< Σ f after ÷ before smoothing − 1
  long long poses_checked = 0;               ///< for interference, in passes and gaps
  long long candidates = 0, candidates_checked = 0;  ///< of the ladder search; the rest was never asked for
  long long pairs_checked = 0,
            pairs_saved = 0;          ///< of bodies, for them; saved: known from another pose there
  std::optional<PaperFigures> paper;  ///< with formulation paper
};
PlanFigures Figures(const PlanResult& plan);

/// One row per point as in docs/outputs.md: positions in W, angles in the arm's convention.
/// `cutter`: of a ball the cutting speed is told where leans were chosen. `lost_motion`: of this plan; null:
/// without its columns.
void WritePointsCsv(const PlanResult& plan, const CutterShape& cutter, const LostMotionReport* lost_motion,
                    int threads, const ByteSink& sink);

/// VTK XML PolyData: the pieces as lines, skipped points as vertices, all indices as point arrays (0 for the
/// pose of a skipped point, distinguished by the array `planned`); positions in W, mm.
void WritePathVtp(const PlanResult& plan, int threads, const ByteSink& sink);

inline constexpr int kSummaryVersion = 2;  ///< schema_version of summary.json

/// summary.json.
std::string SummaryJson(const PlanResult& plan, const ReportInputs& inputs);

/// run.json.
std::string RunJson(const RunFigures& figures);

/// Adds lines "word sentence", as many as there is room for, then how many follow: "3 more", or "3 `all`"
/// where none was told.
void TellSome(const std::string& word, const std::vector<std::string>& sentences, size_t room,
              std::vector<std::string>& lines, const std::string& all = "more");

/// What a run ends with on the terminal, twelve lines at most: done or not and why, programs, cycle times,
/// clearance, the face's error with its largest sources, findings, warnings, where the report is. `folder`:
/// of the results.
std::string BriefText(const PlanResult& plan, const ReportInputs& inputs, const std::string& folder);

std::string SummaryText(const PlanResult& plan, const ReportInputs& inputs, const RunFigures& run);

}  // namespace millpose
