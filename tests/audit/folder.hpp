// SPDX-License-Identifier: GPL-3.0-or-later
// What the judge reads of a plan's output folder. Nothing here is shared with the planner's own modules:
// formats are read anew, so that a mistake there is not repeated here.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "audit/setup.hpp"

namespace millpose::audit {

/// One row of points.csv; a skipped point has no angles.
struct Row {
  int point, pass, piece;
  bool planned, cut;               ///< cut: not a lead
  Vector3 position, normal, axis;  ///< in W, mm
  Vector3 feed_direction;          ///< in W
  Angles angles;                   ///< rad
  Real rotation;                   ///< about the tool axis, rad
  Real lambda_t1, lambda_t2, lambda_n, mu, dexterity, objective;
  Real feed;  ///< mm/s
  /// What programs are given in its place, where the plan is compensated: in W, mm, rad.
  struct Commanded {
    Vector3 position, axis;
    Angles angles;
  };
  std::optional<Commanded> commanded;
  std::vector<Real> external = {};  ///< where the external axes stand, mm or rad; empty where there are none
  /// How the tool leans towards the feed, then to its right, where the plan has chosen it; rad.
  struct Lean {
    Real lead, tilt;
  };
  std::optional<Lean> lean;
  /// What each gear's reversal leaves along the normal, mm, for an arcmin (0.001 mm) where its lost motion is
  /// not known; the arm's six, then external axes. And what lost motion leaves in all.
  std::vector<std::optional<Real>> marks = {};
  std::optional<Real> lost_motion = {};
  bool closed = false;  ///< of a piece that returns to its first point, as plan.cbor.gz says
};

/// A planned way between two pieces, from plan.cbor.gz; pass −1 is home.
struct PlannedLinkMove {
  int from_pass, from_piece, to_pass, to_piece;
  std::vector<Angles> joints;  ///< from the retracted tool to where the approach begins
  /// The external axes move from one position to another while the arm stands at joints[at].
  struct Move {
    std::vector<Real> from, to;
    size_t at;
  };
  std::optional<Move> move = {};
};

/// One row of deflection.csv, in W: the mean force on the tool (N) and what it moves (mm).
struct Deflected {
  Vector3 force, moved;
  Real normal, feed, across, length;
  bool air = false;  ///< nothing is cut there
};

/// What cell.yaml says of gears.
struct Gears {
  using Table = std::array<std::array<Real, 6>, 6>;
  Table couplings{}, axes_by_gear{};       ///< turns of gears by axes (rows: gears), and of axes by gears
  std::vector<std::optional<Real>> width;  ///< lost motion, rad or mm; the arm's six, then external axes
  bool loaded = false;                     ///< load decides as well: marks and lost motion are not judged
};
Gears ReadGears(const std::string& cell);

/// What job.yaml plans for.
struct Goal {
  std::string objective;
  std::string counted = "normal";         ///< which part of the displacement: normal, wall or any
  Real uncertainty = 0, direction = 0;    ///< of the force: a share, rad
  Vector3 given_force = Vector3::Zero();  ///< N, along feed, across, axis; zero: each point's own
  Real max_halfway = 5;                   ///< mm
  Real largest_shift = 0;                 ///< mm, of compensation; 0: none is allowed
  /// Of leans that the plan chooses: their ranges, rad, and the largest change, rad/mm.
  std::array<Real, 2> lead{0, 0}, tilt{0, 0};
  Real max_lean_change = 0;
  std::vector<Real> layers = {0};  ///< mm along the normals above the surface, as `toolpath.depth` says
};

/// The layers of a depth of cut, mm: from the outermost in, even steps of at most `per_layer` down to the
/// last, which takes `finishing` of the total and leaves `allowance`.
std::vector<Real> LayersOf(Real total, Real per_layer, Real allowance, Real finishing);

/// One row of compensation.csv, in W, N and mm: the mean force, the deflection along the normal as expected
/// and within bounds, what is taken out of it, the largest that may remain, and the shift of the tip.
struct Compensated {
  Vector3 force;
  Real low, expected, high, taken, worst_after;
  Vector3 shift;
  Vector3 arm = Vector3::Zero();  ///< beside the shift: for the arm's deviations
};

/// What summary.json says of all points together.
struct Summary {
  Real best_objective, worst_objective, max_halfway;  ///< mm of the last
};

/// A part that its clamps bend, as docs/registration.md says it; in the part's frame, mm.
struct BentPlate {
  struct Mode {
    int u_degree, v_degree;  ///< of Legendre's polynomials
    Real size;
  };
  Vector3 origin, u, v;
  std::vector<Mode> modes;

  Vector3 Bent(const Vector3& p) const;
  Vector3 Unbent(const Vector3& p) const;
  /// Of the unbent surface in p, where n is the bent one's.
  Vector3 UnbentNormal(const Vector3& p, const Vector3& n) const;
  Mesh Bent(const Mesh& part) const;  ///< in small triangles, to a µm
};

/// How an arm differs from what its controller computes with.
struct OwnArm {
  std::array<Matrix4, 7> frames;  ///< as Setup::deviations
  std::vector<Setup::Wave> waves;
  std::vector<Setup::Follower> followers;

  Setup In(Setup nominal) const {
    nominal.deviations = frames;
    nominal.waves = waves;
    nominal.followers = followers;
    return nominal;
  }
};

/// A folder as read.
struct Folder {
  std::optional<BentPlate> plate;               ///< of a bent part
  Mesh unbent;                                  ///< that part before
  Setup setup;                                  ///< with the external axes at 0
  std::map<std::vector<Real>, Setup> stations;  ///< with them where rows have them
  std::vector<Row> rows;
  bool whole = true;         ///< no point is skipped
  bool leans = false;        ///< the plan chose them: points.csv tells them
  bool along_normal = true;  ///< the job has the tool along the surface's normal, the tip on the surface
  std::vector<PlannedLinkMove> gaps;
  std::optional<OwnArm> own_arm;  ///< where the programs are for the arm as it is
  Goal goal;
  Real cutter_radius = 0, corner_radius = 0;  ///< mm
  std::map<int, Deflected> deflected;         ///< by point
  std::map<int, Compensated> compensated;
  std::optional<Summary> summary;
  Gears gears;
  /// Of summary.json, by pass and gear; empty where it does not tell them.
  std::optional<std::map<std::pair<int, size_t>, int>> reversals;
  bool all_air = false;  ///< deflection.csv has no point in material
  std::map<std::string, std::map<std::string, std::string>> programs;  ///< controller → file name → text

  /// The cell with the external axes somewhere that a row has them; without its bodies where it has any.
  const Setup& At(const std::vector<Real>& external) const {
    return external.empty() ? setup : stations.at(external);
  }
  /// The arm that runs the programs.
  Setup AsItIs(Setup nominal) const { return own_arm ? own_arm->In(std::move(nominal)) : nominal; }
};

/// Reads `path`. Cell and mesh are named in job.yaml relative to where the job was: `inputs`, else the folder
/// itself or the one that it lies in. Throws an exception that says what is missing or malformed.
Folder ReadFolder(const std::filesystem::path& path, const std::filesystem::path& inputs = {});

/// The cell and job that `job` (the bytes of a resolved job.yaml) names, in the first of `starts` where they
/// are. `resolved`: bytes of the cell.yaml of an output folder, which a cell with a URDF needs.
Setup ReadSetup(const std::string& job, const std::vector<std::filesystem::path>& starts,
                const std::string& resolved = {});

/// Parts of ReadFolder.
Goal ReadGoal(const std::string& job);
std::optional<OwnArm> ReadCommandedArm(const std::string& job, const std::string& cell);
/// The arm of a cell that says how it differs from its sheet.
OwnArm ReadOwnArm(const std::string& cell);
std::map<int, Compensated> ReadCompensated(const std::string& csv, const Matrix3& R_WP);
std::map<int, Deflected> ReadDeflected(const std::string& csv, const Matrix3& R_WP);
std::optional<Summary> ReadSummary(const std::string& json);
std::optional<std::map<std::pair<int, size_t>, int>> ReadReversals(const std::string& json);
std::vector<PlannedLinkMove> ReadLinkMoves(const std::string& cbor);
/// Marks the rows of pieces that return to their first point.
void MarkClosed(const std::string& cbor, std::vector<Row>& rows);
UrdfArm ReadUrdf(const std::string& xml, const std::string& base, const std::string& flange);
std::vector<Row> ReadPoints(const std::string& csv);
Mesh ReadStl(const std::string& bytes, Real unit);

}  // namespace millpose::audit
