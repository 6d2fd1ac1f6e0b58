// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/good_folder.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tests/audit/kinematics.hpp"
#include "tests/audit/laws.hpp"
#include "tests/base/replaced.hpp"

namespace millpose::audit {
namespace {

constexpr const char* kCell = R"(millpose_cell: 1
name: made_by_hand
arm:
  name: by hand
  lengths_mm: {d1: 1045, a1: 500, a2: 1300, d4: 1025, dz: -55, d6: 290}
  axis_signs: [-1, 1, 1, -1, 1, -1]
  zero_offsets_deg: [0, 0, 0, 0, 0, 0]
  limits_deg: [[-185, 185], [-130, 20], [-100, 144], [-350, 350], [-120, 120], [-350, 350]]
  speeds_deg_s: [80, 75, 70, 70, 70, 110]
  joint_stiffness_Nm_per_rad: [8.9e6, 6.78e6, 1.13e7, 2.01e6, 1.65e6, 1.35e6]
base_in_world: {xyz_mm: [100, -50, 300], abc_deg: [10, 0, 0]}
home_deg: [0, -90, 90, 0, 0, 0]
tool:
  tip_in_flange_mm: [-250, 0, 250]
  axis_in_flange: [1, 0, 0]
  x_in_flange: [0, 0, 1]
  cutter: {shape: flat, diameter_mm: 20, cutting_length_mm: 40}
  stack:
    - {name: cutter, class: cutter, length_mm: 60, diameter_mm: 20}
    - {name: spindle, class: spindle, length_mm: 320, diameter_mm: 160}
bodies:
  - {name: forearm, class: link, mount: link3, shape: {capsule: {diameter_mm: 300, length_mm: 600}}, pose: {xyz_mm: [500, 0, 0], abc_deg: [0, 90, 0]}}
  - {name: column, class: link, mount: base, shape: {cylinder: {diameter_mm: 400, length_mm: 500}}, pose: {xyz_mm: [0, 0, 250]}}
  - {name: post, class: fixture, mount: workpiece, shape: {box: {size_mm: [20, 20, 20]}}, pose: {xyz_mm: [POST, 0, 200]}}
excluded_pairs: []
stiffness: {at: tool_tip, characteristic_length_mm: 1000}
controllers:
  krl: {tool_axis: xKRL_AXES}
)";

/// The rail along the base's y, as KRL and SINUMERIK count it in and LinuxCNC does not.
constexpr const char* kRail = R"(external_axes:
  - {name: rail, kind: linear, carries: robot, axis: [ALONG], limits_mm: [-150, 900], speed_mm_s: 14, acceleration_mm_s2: 500}
)";
constexpr const char* kKrlAxes =
    ", external_axes: [{name: E1, axis: rail, coupled: true}], ersysroot: {pose: {xyz_mm: [0, 0, 50]}, "
    "direction: y}, robroot: {xyz_mm: [0, 0, -50]}";
constexpr const char* kOtherAxes =
    R"(  sinumerik: {external_axes: [{name: RAIL_AX, axis: rail, coupled: true}]}
  linuxcnc: {external_axes: [{name: U, axis: rail, coupled: false}]}
)";

constexpr const char* kJob = R"(millpose_job: 1
name: by_hand
cell: cell.yaml
workpiece: {mesh: block.stl, unit: mm, frame: robot_base, pose: {xyz_mm: [XYZ], abc_deg: [ABC]}}
toolpath: {strategy: parallel_planes, spacing_mm: 4}
process: {force_uncertainty_percent: 30, force_direction_deg: 20}
pose: {objective: {name: chen2021, w1: 0.5, w2: 0.5}}
limits: {margin_deg: 3LIMITS}
path: {max_joint_deg_per_mm: 1.25, joint_speed_share: 0.25, max_halfway_deviation_mm: 5}
)";

const char* const kHeader =
    "point,pass,piece,kind,status,s_mm,x_mm,y_mm,z_mm,nx,ny,nz,tx,ty,tz,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,"
    "a6_deg,"
    "rotation_deg,branch,lambda_t1_mm_N,lambda_t2_mm_N,lambda_n_mm_N,mu,dexterity,objective,clearance_mm,"
    "feed_mm_min,fx,fy,fz\n";

std::string Join(const Vector3& v) {
  return fmt::format("{:.17g},{:.17g},{:.17g}", static_cast<double>(v[0]), static_cast<double>(v[1]),
                     static_cast<double>(v[2]));
}

/// A, B, C in degrees of Rz(A)·Ry(B)·Rx(C).
Vector3 AbcOf(const Matrix4& X) {
  // Where B is ±90° only A ± C counts, and what is left of the first column is noise.
  const Real a = std::hypot(X(0, 0), X(1, 0)) > 1e-9L ? std::atan2(X(1, 0), X(0, 0)) : 0;
  const Matrix4 rest = Turn(2, -a) * X;
  return Vector3(a, std::atan2(-rest(2, 0), rest(0, 0)), std::atan2(-rest(1, 2), rest(1, 1))) / kDegree;
}

Setup MakeSetup() {
  Setup s{};
  s.d1 = 1045, s.a1 = 500, s.a2 = 1300, s.d4 = 1025, s.dz = -55, s.d6 = 290;
  s.sign = {-1, 1, 1, -1, 1, -1};
  for (size_t i = 0; i < 6; ++i)
    s.stiffness[i] = std::array<Real, 6>{8.9e9L, 6.78e9L, 1.13e10L, 2.01e9L, 1.65e9L, 1.35e9L}[i];
  s.home = {0, -90 * kDegree, 90 * kDegree, 0, 0, 0};
  s.X_WB = FrameXyzAbc(100, -50, 300, 10, 0, 0);
  s.X_FT = Matrix4::Identity();
  s.X_FT.block<3, 3>(0, 0) << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  s.X_FT.block<3, 1>(0, 3) << -250, 0, 250;
  s.X_WP = Matrix4::Identity();
  s.w1 = s.w2 = 0.5L;
  return s;
}

std::string BlockStl() {
  // 200 × 200 × 50 mm, its top at z = 0; FCL asks for no normals.
  std::string stl = "solid block\n";
  const int corner[8][3] = {{-100, -100, -50}, {100, -100, -50}, {100, 100, -50}, {-100, 100, -50},
                            {-100, -100, 0},   {100, -100, 0},   {100, 100, 0},   {-100, 100, 0}};
  const int face[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                           {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  for (const auto& f : face) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const int v : f) stl += fmt::format("vertex {} {} {}\n", corner[v][0], corner[v][1], corner[v][2]);
    stl += "endloop\nendfacet\n";
  }
  return stl + "endsolid block\n";
}

/// Writes the three programs side by side.
class Programs {
 public:
  Programs(const Setup& setup, const Matrix4& X_BP, bool cartesian)
      : setup_(setup), X_BP_(X_BP), cartesian_(cartesian) {
    X_TC_ << 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1;
    krl_ = fmt::format("DEF BY_HAND( )\n$BASE = {{FRAME: {}}}\n$TOOL = {{FRAME: {}}}\n", Krl(X_BP),
                       Krl(setup.X_FT * X_TC_));
    const Vector3 abc = AbcOf(X_BP);
    sinumerik_ = fmt::format(
        "G710 "
        "G90\n$P_UIFR[1]=CTRANS(X,{:.4f},Y,{:.4f},Z,{:.4f}):CROT(X,{:.6f},Y,{:.6f},Z,{:.6f})\nTRAORI\nG54\n",
        static_cast<double>(X_BP(0, 3)), static_cast<double>(X_BP(1, 3)), static_cast<double>(X_BP(2, 3)),
        static_cast<double>(abc[2]), static_cast<double>(abc[1]), static_cast<double>(abc[0]));
    linuxcnc_ = "; joints\nG21 G90\n";
  }

  /// The rail stands there from now on, mm; `here` is the cell then.
  void Stand(const Setup& here, Real rail) {
    here_ = here;
    rail_ = static_cast<double>(rail);
  }

  void Linear(const Angles& angles) {
    Straight(Tool(here_, angles));
    if (!cartesian_) return LinuxCnc(angles);
    const Matrix4 X_BT = setup_.X_WB.inverse() * Tool(setup_, angles);
    const Vector3 turned = AbcOf(X_BT);
    linuxcnc_ += fmt::format("M68 E3 Q0\nG1 X{:.4f} Y{:.4f} Z{:.4f} A{:.6f} B{:.6f} C{:.6f} F80\n",
                             static_cast<double>(X_BT(0, 3)), static_cast<double>(X_BT(1, 3)),
                             static_cast<double>(X_BT(2, 3)), static_cast<double>(turned[2]),
                             static_cast<double>(turned[1]), static_cast<double>(turned[0]));
  }

  /// KRL and SINUMERIK.
  void Straight(const Matrix4& X_WT) {
    const Matrix4 X_PT = (setup_.X_WB * X_BP_).inverse() * X_WT;
    const Vector3 abc = AbcOf(X_PT);
    krl_ += fmt::format("LIN {{{}{}}} C_DIS\n", Krl(X_PT * X_TC_), Word(",E1 "));
    sinumerik_ += fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f} A={:.6f} B={:.6f} C={:.6f}{} F80\n",
                              static_cast<double>(X_PT(0, 3)), static_cast<double>(X_PT(1, 3)),
                              static_cast<double>(X_PT(2, 3)), static_cast<double>(abc[2]),
                              static_cast<double>(abc[1]), static_cast<double>(abc[0]), Word(" RAIL_AX="));
  }

  void Joint(const Angles& angles) {
    krl_ += "PTP {";
    sinumerik_ += "TRAFOOF\nG0";
    for (size_t i = 0; i < 6; ++i) {
      const double degrees = static_cast<double>(angles[i] / kDegree);
      krl_ += fmt::format("{}A{} {:.6f}", i ? "," : "", i + 1, degrees);
      sinumerik_ += fmt::format(" RA{}={:.6f}", i + 1, degrees);
    }
    krl_ += Word(",E1 ") + "}\n";
    sinumerik_ += Word(" RAIL_AX=") + "\nTRAORI\n";
    LinuxCnc(angles);
  }

  void Finish(Texts& texts) {
    texts["out/programs/krl/by_hand.src"] = krl_ + "END\n";
    texts["out/programs/sinumerik/by_hand.mpf"] = sinumerik_ + "M30\n";
    texts["out/programs/linuxcnc/by_hand.ngc"] = linuxcnc_ + "M2\n";
  }

 private:
  void LinuxCnc(const Angles& angles) {
    if (cartesian_) linuxcnc_ += "M68 E3 Q1\n";
    linuxcnc_ += "G1";
    for (size_t i = 0; i < 6; ++i)
      linuxcnc_ += fmt::format(" {}{:.6f}", "XYZABC"[i], static_cast<double>(angles[i] / kDegree));
    linuxcnc_ += Word(" U") + " F1\n";
  }

  std::string Word(const char* name) const { return rail_ ? fmt::format("{}{:.4f}", name, *rail_) : ""; }

  static std::string Krl(const Matrix4& X) {
    const Vector3 abc = AbcOf(X);
    return fmt::format("X {:.4f},Y {:.4f},Z {:.4f},A {:.6f},B {:.6f},C {:.6f}", static_cast<double>(X(0, 3)),
                       static_cast<double>(X(1, 3)), static_cast<double>(X(2, 3)),
                       static_cast<double>(abc[0]), static_cast<double>(abc[1]), static_cast<double>(abc[2]));
  }

  const Setup& setup_;
  Setup here_ = setup_;
  std::optional<double> rail_;
  Matrix4 X_BP_, X_TC_;
  bool cartesian_;
  std::string krl_, sinumerik_, linuxcnc_;
};

/// points.csv, deflection.csv and the summary, point by point.
class Figures {
 public:
  Figures(const Setup& setup, const Matrix3& R_WP, bool forces) : R_WP_(R_WP), forces_(forces) {
    folder_.setup = here_ = setup;
    folder_.goal = {
        .objective = forces ? "surface_error" : "chen2021", .uncertainty = 0.3L, .direction = 20 * kDegree};
  }

  /// The rail stands there from now on, mm; `here` is the cell then.
  void Stand(const Setup& here, Real rail) {
    here_ = here;
    rail_ = rail;
  }

  void Add(int pass, const Angles& angles, double rotation_deg, const char* kind) {
    const Matrix4 X_WT = Tool(here_, angles);
    Row row{};
    if (rail_) row.external = {*rail_};
    row.point = static_cast<int>(folder_.rows.size());
    row.position = X_WT.block<3, 1>(0, 3);
    row.axis = row.normal = X_WT.block<3, 1>(0, 2);
    row.feed_direction = R_WP_.col(0);
    row.angles = angles;
    const Indices indices = ComputeIndices(here_, angles, row.normal);
    row.objective = forces_ ? Deflect(pass, row) : indices.objective;
    points_ += fmt::format("{},{},0,{},planned,0,{},{},{}", row.point, pass, kind, Join(row.position),
                           Join(row.axis), Join(row.axis));
    for (const Real angle : angles) points_ += fmt::format(",{:.17g}", static_cast<double>(angle / kDegree));
    points_ += fmt::format(",{:.17g},2", rotation_deg);
    for (const Real figure : {indices.lambda_t1, indices.lambda_t2, indices.lambda_n, indices.mu,
                              indices.dexterity, row.objective})
      points_ += fmt::format(",{:.17g}", static_cast<double>(figure));
    points_ += fmt::format(",10,80,{}", Join(row.feed_direction));
    points_ += rail_ ? fmt::format(",{:.17g}\n", static_cast<double>(*rail_)) : "\n";
    folder_.rows.push_back(row);
  }

  void Finish(Texts& texts) {
    texts["out/points.csv"] = rail_ ? Replaced(points_, "\n", ",e1_mm\n") : points_;
    if (!forces_) return;
    texts["out/deflection.csv"] = deflections_;
    Real best = folder_.rows[0].objective, worst = 0, halfway = 0;
    for (const Row& row : folder_.rows)
      best = std::min(best, row.objective), worst = std::max(worst, row.objective);
    for (const size_t k : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 10u, 11u})  // within the two passes
      halfway = std::max(halfway, HalfwayDeviation(folder_.setup, PostureOf(k - 1), PostureOf(k)));
    texts["out/summary.json"] =
        fmt::format(R"({{"stiffness": {{"objective": {{"best": {:.17g}, "worst": {:.17g}}}}},
"continuity": {{"halfway_deviation_max_mm": {:.17g}}}}})",
                    static_cast<double>(best), static_cast<double>(worst), static_cast<double>(halfway));
  }

 private:
  Posture PostureOf(size_t k) const { return {folder_.rows[k].angles, folder_.rows[k].external}; }

  /// Writes a row of deflection.csv; the objective.
  Real Deflect(int pass, const Row& row) {
    const Matrix3 c = ComplianceAt(here_, row.angles);
    const Vector3 force(-20 - row.point, 15, 4), F = R_WP_ * force, moved = c * F;
    folder_.deflected[row.point].force = F;
    const Vector3 across = row.normal.cross(row.feed_direction);
    deflections_ += fmt::format("{},{},down,9,1,{},{}", row.point, pass, Join(force),
                                Join(1000 * R_WP_.transpose() * moved));
    for (const Real part :
         {row.normal.dot(moved), row.feed_direction.dot(moved), across.dot(moved), moved.norm()})
      deflections_ += fmt::format(",{:.17g}", static_cast<double>(1000 * part));
    deflections_ += "\n";
    return ObjectiveOf(folder_, row, c)->value;
  }

  Folder folder_;
  Setup here_ = folder_.setup;
  std::optional<Real> rail_;
  Matrix3 R_WP_;
  bool forces_;
  std::string points_ = kHeader;
  std::string deflections_ =
      "point,pass,side,width_mm,depth_mm,force_x_N,force_y_N,force_z_N,x_um,y_um,z_um,normal_um,feed_um,"
      "across_um,length_um\n";
};

}  // namespace

Texts MakeFolder(const Fault& fault) {
  constexpr int kPasses = 2, kPoints = 6;
  constexpr Real kRetract = 200;  // mm: from there the way home is free
  Setup setup = MakeSetup();
  if (fault.rail_step_mm) {
    ExternalAxis rail{};
    rail.name = "rail";
    rail.carries_robot = true;
    rail.direction = setup.X_WB.block<3, 1>(0, 1);
    rail.origin.setZero();
    setup.axes.push_back(rail);
  }
  Setup here = setup;
  Angles angles{5, -65, 105, 25, 50, -40};
  for (Real& angle : angles) angle *= kDegree;
  // The block's place: four decimals of what the tool reaches at those angles, so that programs can state it
  // exactly.
  const Matrix4 reached = setup.X_WB.inverse() * Tool(setup, angles);
  const auto rounded = [](const Vector3& v) -> Vector3 { return (v * 1e4L).array().round() / 1e4L; };
  const Vector3 xyz = rounded(reached.block<3, 1>(0, 3)), abc = rounded(AbcOf(reached));
  const Matrix4 X_BP = FrameXyzAbc(xyz[0], xyz[1], xyz[2], abc[0], abc[1], abc[2]);

  Texts texts;
  Programs programs(setup, X_BP, fault.cartesian);
  const auto stand = [&](Real rail, Figures* figures) {
    if (!fault.rail_step_mm) return;
    here = At(setup, {rail});
    programs.Stand(here, rail);
    if (figures) figures->Stand(here, rail);
  };
  stand(0, nullptr);
  programs.Joint(setup.home);
  Figures figures(setup, Matrix3((setup.X_WB * X_BP).block<3, 3>(0, 0)), fault.forces);
  Real largest = -1e9L, second = -1e9L;  // A1
  Real unfolded = -1e9L;                 // A2 − A3
  for (int pass = 0; pass < kPasses; ++pass) {
    const auto pose = [&](int k, Real height, Real turn) {
      return Matrix4(setup.X_WB * X_BP * Shift(4 * k, 8 * pass, height) * Turn(2, turn));
    };
    if (fault.rail_step_mm && pass > 0) programs.Joint(setup.home);
    stand(100 * (pass + 1), &figures);
    if (fault.rail_step_mm) programs.Joint(setup.home);
    programs.Joint(Solve(here, pose(0, kRetract, 0), angles));
    for (int k = 0; k < kPoints; ++k) {
      const bool faulty = pass == 1 && k == 3;
      const bool lead = fault.lead_mm != 0 && pass == 1 && k == kPoints - 1;
      const double lift = faulty ? fault.lift_mm : lead ? fault.lead_mm : 0;
      stand(100 * (pass + 1) + fault.rail_step_mm.value_or(0) * k, &figures);
      angles = Solve(
          here,
          pose(k, lift + (fault.layers && pass == 0 ? 1 : 0), faulty ? fault.rotation_deg * kDegree : 0),
          angles);
      figures.Add(pass, angles, faulty ? fault.rotation_deg : 0, lead ? "lead-out" : "cut");
      programs.Linear(angles);
      unfolded = std::max(unfolded, angles[1] - angles[2]);
      second = std::max(std::min(largest, angles[0]), second);
      largest = std::max(largest, angles[0]);
    }
    programs.Linear(Solve(here, pose(kPoints - 1, kRetract, 0), angles));
  }
  programs.Joint(setup.home);
  if (fault.rail_step_mm) {
    stand(0, nullptr);
    programs.Joint(setup.home);
  }
  programs.Finish(texts);
  figures.Finish(texts);

  const double upper = static_cast<double>((largest + second) / 2 / kDegree) + 3;  // less the margin
  const std::string limits = fmt::format(
      ", joints_deg: [[-185, {:.17g}], [-130, 20], [-100, 144], [-350, 350], [-120, 120], [-350, 350]]",
      upper);
  texts["out/job.yaml"] = Replaced(Replaced(Replaced(kJob, "XYZ", Join(xyz)), "ABC", Join(abc)), "LIMITS",
                                   fault.narrow_limits ? limits : "");
  if (fault.forces)
    texts["out/job.yaml"] =
        Replaced(texts["out/job.yaml"], "name: chen2021, w1: 0.5, w2: 0.5", "name: surface_error");
  if (fault.layers)
    texts["out/job.yaml"] = Replaced(texts["out/job.yaml"], "spacing_mm: 4",
                                     "spacing_mm: 4, depth: {total_mm: 2, per_layer_mm: 1}");
  const bool rail = fault.rail_step_mm.has_value();
  std::string& cell = texts["cell.yaml"] = Replaced(
      Replaced(kCell, "POST", fault.fixture_in_way ? "80" : "800"), "KRL_AXES", rail ? kKrlAxes : "");
  if (rail) {
    const std::string axes = Replaced(kRail, "ALONG", Join(setup.axes[0].direction));
    cell = Replaced(cell, "home_deg", axes + "home_deg") + kOtherAxes;
  }
  if (fault.coupled_room_deg)
    cell = Replaced(
        cell, "  limits_deg:",
        fmt::format("  coupled_limits_deg: [{{a: [0, 1, -1, 0, 0, 0], at_most: {:.17g}}}]\n  limits_deg:",
                    static_cast<double>(unfolded / kDegree) + 3 + *fault.coupled_room_deg));
  texts["block.stl"] = BlockStl();
  return texts;
}

Texts OneMotion(const Setup& setup, const Matrix4& from, const Matrix4& to) {
  Programs programs(setup, setup.X_WB.inverse() * setup.X_WP, false);
  programs.Straight(from);
  programs.Straight(to);
  Texts texts, files;
  programs.Finish(texts);
  for (const auto& [path, text] : texts) files[path.substr(path.rfind('/') + 1)] = text;
  return files;
}

void EditLine(std::string& text, size_t line, const std::function<std::string(std::string)>& edit) {
  size_t begin = 0;
  for (; line > 0; --line) begin = text.find('\n', begin) + 1;
  const size_t length = text.find('\n', begin) - begin;
  text.replace(begin, length, edit(text.substr(begin, length)));
}

}  // namespace millpose::audit
