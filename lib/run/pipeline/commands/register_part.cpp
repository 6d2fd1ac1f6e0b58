// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/register_part.hpp"

#include <cmath>
#include <set>

#include "base/angles.hpp"
#include "base/csv.hpp"
#include "base/error.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "job/config/setup_names.hpp"
#include "job/locate.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "machine/collision/world.hpp"
#include "machine/robot/kinematics.hpp"
#include "machine/robot/make_pose.hpp"
#include "program/controller_axes.hpp"
#include "run/pipeline/operations/run_job.hpp"
#include "toolpath/pass_ends.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

// mm, degrees, mm: far below what is known.
constexpr int kLengthDecimals = 4, kAngleDecimals = 7, kModeDecimals = 6;

/// The points, each with the line it came from.
struct ProbedSet {
  std::vector<ProbedPoint> points;
  std::vector<std::pair<std::string, int>> lines;
};

/// What columns a file has beside x_mm,y_mm,z_mm.
CsvColumns ColumnsOf(ProbedOn on) {
  CsvColumns columns{{"x_mm", "y_mm", "z_mm"}, {"sd_mm"}};
  if (on == ProbedOn::kTarget)
    columns.required.insert(columns.required.end(), {"nominal_x_mm", "nominal_y_mm", "nominal_z_mm"});
  if (on == ProbedOn::kFace) columns.optional.insert(columns.optional.end(), {"radius_mm", "nx", "ny", "nz"});
  return columns;
}

class ProbedReader {
 public:
  ProbedReader(const RegisterArguments& arguments, ProbedSet& set) : arguments_(arguments), set_(set) {}

  void Read(const std::optional<std::filesystem::path>& file, ProbedOn on) {
    if (!file) return;
    name_ = file->string();
    const CsvTable table = ReadCsv(arguments_.root.Read(*file), name_, ColumnsOf(on));
    const bool nx = table.Has("nx"), ny = table.Has("ny"), nz = table.Has("nz");
    if (nx != ny || nx != nz)
      throw InputError({name_, 1}, "a normal needs three columns; allowed: nx,ny,nz, or none of them");
    if (!table.Has("sd_mm") && !arguments_.sd)
      throw InputError({name_, 1},
                       "nobody says how well these points are known; allowed: a column sd_mm, or --sd-mm");
    if (on == ProbedOn::kFace && !table.Has("radius_mm") && !arguments_.radius)
      throw InputError({name_, 1},
                       "nobody says how large the probe's ball is; allowed: a column radius_mm, or "
                       "--tool-radius-mm (0 where the points lie on the face itself)");
    for (size_t row = 0; row < table.size(); ++row) Add(table, row, on, nx);
  }
  void ThrowProblems() {
    if (!problems_.empty()) throw InputError(std::move(problems_));
  }

 private:
  void Add(const CsvTable& table, size_t row, ProbedOn on, bool has_normal) {
    const auto number = [&](const char* column, double lower, double upper) {
      const double value = table.At(row, column);
      if (!(value >= lower && value <= upper))
        problems_.push_back({{name_, table.line(row)},
                             fmt::format("{}: given {}; allowed: {} to {}", column, value, lower, upper)});
      return value;
    };
    const auto vector = [&](const char* x, const char* y, const char* z, double most) {
      return Vector3d(number(x, -most, most), number(y, -most, most), number(z, -most, most));
    };
    constexpr double kMost = 1e6, kLeastSd = 1e-4, kMostSd = 100, kMostRadius = 100;  // mm
    ProbedPoint point;
    point.on = on;
    point.measured = vector("x_mm", "y_mm", "z_mm", kMost);
    point.sd = table.Has("sd_mm") ? number("sd_mm", kLeastSd, kMostSd) : *arguments_.sd;
    if (on == ProbedOn::kFace)
      point.radius = table.Has("radius_mm") ? number("radius_mm", 0, kMostRadius) : *arguments_.radius;
    if (has_normal) {
      const Vector3d n = vector("nx", "ny", "nz", kMost);
      if (n.norm() < 1e-6)
        problems_.push_back({{name_, table.line(row)}, "nx,ny,nz: given no direction; allowed: a vector"});
      point.normal = n.normalized();
    }
    if (on == ProbedOn::kTarget)
      point.nominal = vector("nominal_x_mm", "nominal_y_mm", "nominal_z_mm", kMost);
    set_.points.push_back(point);
    set_.lines.emplace_back(name_, table.line(row));
  }

  const RegisterArguments& arguments_;
  ProbedSet& set_;
  std::string name_;
  std::vector<Problem> problems_;
};

ProbedSet ReadProbed(const RegisterArguments& arguments) {
  ProbedSet set;
  ProbedReader reader(arguments, set);
  reader.Read(arguments.faces, ProbedOn::kFace);
  reader.Read(arguments.edges, ProbedOn::kEdge);
  reader.Read(arguments.holes, ProbedOn::kHole);
  reader.Read(arguments.targets, ProbedOn::kTarget);
  reader.ThrowProblems();
  if (set.points.empty())
    throw InputError({arguments.job.string()},
                     "no probed point; allowed: --probe, --edges, --holes, --targets, with a point at least");
  return set;
}

void RefuseJob(const JobInputs& inputs) {
  const WorkpieceSettings& workpiece = inputs.job.workpiece;
  if (workpiece.mesh_file.empty())
    throw InputError({inputs.job.file},
                     "workpiece.mesh: is missing; there is nothing that points could lie on");
  if (!workpiece.targets.empty())
    throw InputError(
        {inputs.job.file},
        "workpiece.targets: the part is placed by them; allowed: workpiece.pose, roughly, and the "
        "targets in a file of their own (--targets)");
}

std::vector<PartPlace> CutPlaces(const std::vector<JobInputs>& operations, const Mesh& mesh,
                                 const std::stop_token& stop) {
  std::vector<PartPlace> places;
  for (const JobInputs& inputs : operations)
    for (const Pass& pass :
         WithPlaces(inputs, [&] { return MakeJobToolpath(inputs, mesh, stop); }).toolpath.passes)
      for (const MillingPoint& point : pass.points)
        if (point.kind == PointKind::kCut) places.push_back({point.position, point.normal});
  return places;
}

/// The least that the last layer of any operation takes off, mm; none where no job says its depth.
std::optional<double> LeastLastLayer(const std::vector<JobInputs>& operations) {
  std::optional<double> least;
  for (const JobInputs& inputs : operations) {
    const Layers& layers = inputs.job.toolpath.layers;
    if (layers.total <= 0) continue;
    const std::vector<double> offsets = LayerOffsets(layers);
    const double above = offsets.size() > 1 ? offsets[offsets.size() - 2] - offsets.back() : layers.total;
    least = std::min(least.value_or(above), above);
  }
  return least;
}

PoseSettings AsWritten(const Pose& X) {
  const Vector3d abc = AnglesZyx(X.linear());
  PoseSettings pose;
  for (int k = 0; k < 3; ++k) {
    pose.position[k] = Rounded(X.translation()[k], kLengthDecimals);
    pose.abc[k] = DegToRad(Rounded(RadToDeg(abc[k]), kAngleDecimals));
  }
  return pose;
}

/// Whether the arm stands free with the tool's tip a little before a place, the tool along its normal.
class ProbeReach {
 public:
  ProbeReach(Cell cell, const AdmissibleBounds& bounds)
      : world_(std::move(cell)), checker_(world_), bounds_(bounds) {}

  bool operator()(const PartPlace& place) {
    constexpr int kTurns = 12;
    constexpr double kBefore = 30;  // mm
    const Cell& cell = world_.cell();
    int least = 0;
    place.normal.cwiseAbs().minCoeff(&least);
    const Vector3d z = cell.X_WP.linear() * place.normal;
    const Vector3d across = cell.X_WP.linear() * place.normal.cross(Vector3d::Unit(least)).normalized();
    for (int turn = 0; turn < kTurns; ++turn) {
      const SineCosine angle = SinCos(2 * kPi * turn / kTurns);
      const Vector3d x = angle.cos * across + angle.sin * z.cross(across);
      Pose X_WT = Pose::Identity();
      X_WT.linear() << x, z.cross(x), z;
      X_WT.translation() = cell.X_WP * (place.position + kBefore * place.normal);
      const InverseResult inverse =
          Inverse(cell.arm, cell.X_WB.inverse(Eigen::Isometry) * X_WT * cell.X_FT.inverse(Eigen::Isometry));
      for (int s = 0; s < inverse.count; ++s)
        for (const Joints& q : FullRevolutions(inverse.solutions[s].q, bounds_.lower, bounds_.upper))
          if (!checker_.Blocked(q, Phase::kFree)) return true;
    }
    return false;
  }

 private:
  World world_;
  Checker checker_;
  AdmissibleBounds bounds_;
};

void Propose(const RegisterArguments& arguments, const JobInputs& inputs, const ProbedPart& part,
             const ProbedSet& probed, const std::vector<PartPlace>& face, Cell cell, RegisteredPart& result) {
  if (arguments.propose <= 0 || !result.found.determined() || !(result.error.off_95 > 0)) return;
  constexpr double kSpacings = 12;  // of the part's size
  constexpr double kFromEdge = 5;   // mm beside the ball
  constexpr size_t kCandidates = 1000;
  double sd = 0, radius = 0;
  for (const ProbedPoint& point : probed.points) {
    sd += point.sd / static_cast<double>(probed.points.size());
    radius = std::max(radius, point.radius);
  }
  const std::vector<PartPlace> candidates = PlacesToProbe(
      part.mesh(), part.size() / kSpacings, radius + kFromEdge, inputs.job.toolpath.crease, kCandidates);
  ProbeReach reach(std::move(cell), MakeBounds(inputs.job, MakeArm(inputs.cell.arm)));
  const double now = result.error.sd[result.error.worst];
  for (const NextPlace& next : ProposePlaces(
           result.found.covariance, result.found.centre, face, candidates,
           sd * std::max(1.0, result.found.scatter), arguments.propose,
           [&](size_t candidate) { return reach(candidates[candidate]); }, result.found.Bending()))
    result.next.push_back({candidates[next.candidate], result.error.off_95 * next.worst_sd / now});
}

/// What is wrong with the part's bending; empty: nothing.
std::string BendingFinding(const RegisteredPart& part) {
  if (!part.bent || part.found.bending) return {};
  const BentRegistration& bent = *part.bent;
  const std::string by =
      fmt::format("the part is bent by up to {:.3f} ± {:.3f} mm (95 %; by chance: p {:.1g})", bent.largest,
                  bent.largest_95, bent.p);
  if (!part.max_bending) {
    // A rigid part's figures hold where what they leave out is no larger.
    const double room = part.tolerance ? *part.tolerance - part.error.off_95 : part.error.off_95;
    if (bent.largest <= room) return {};
    return by +
           ", and the face is not where a rigid one would be: allow it by "
           "workpiece.registration.max_bending_mm (0: take it as rigid all the same)";
  }
  if (*part.max_bending <= 0) return {};
  if (bent.largest > *part.max_bending)
    return by + fmt::format("; allowed: workpiece.registration.max_bending_mm, {:.3f} mm", *part.max_bending);
  return by + fmt::format(" at a slope of {:.2f}; allowed: {} mm/mm", bent.slope, kSteepestBending);
}

void Judge(const ProbedSet& probed, RegisteredPart& part) {
  const Registration& found = part.found;
  double squares = 0;
  size_t counted = 0, lost = 0;
  for (size_t i = 0; i < probed.points.size(); ++i) {
    const ProbeResidual& residual = found.residuals[i];
    const auto& [file, line] = probed.lines[i];
    if (residual.outlier) part.outliers.push_back({file, line, residual.distance, residual.standardised});
    if (residual.no_feature && ++lost == 1)
      part.findings.push_back(
          fmt::format("{}:{}: the part has nothing there that the point could lie on", file, line));
    if (residual.outlier || residual.no_feature) continue;
    squares += residual.distance * residual.distance;
    ++counted;
  }
  part.rms = counted > 0 ? std::sqrt(squares / static_cast<double>(counted)) : 0;
  std::ranges::stable_sort(part.outliers, std::greater<>(), &ProbeOutlier::standardised);
  if (3 * part.outliers.size() > part.points)
    part.findings.push_back(fmt::format(
        "{} of {} points do not lie on the part as the others say: the wrong part, side, unit or start",
        part.outliers.size(), part.points));
  for (const std::string& way : found.undetermined)
    part.findings.push_back(
        fmt::format("no point tells {} (workpiece's frame): probe faces that look another way", way));
  if (!found.converged)
    part.findings.emplace_back(
        "the fit does not come to rest: the job's pose is too far from where the part is");
  if (std::string finding = BendingFinding(part); !finding.empty())
    part.findings.push_back(std::move(finding));
  if (found.determined() && part.tolerance && part.error.off_95 > *part.tolerance)
    part.findings.push_back(
        fmt::format("the face may be off by {:.0f} µm (95 %); allowed: "
                    "workpiece.registration.tolerance_mm, {:.0f} µm",
                    1000 * part.error.off_95, 1000 * *part.tolerance));
  if (found.determined() && part.last_layer && part.error.off_95 > *part.last_layer)
    part.findings.push_back(
        fmt::format("the face may be off by {:.0f} µm (95 %), more than its last layer takes off "
                    "(toolpath.depth, {:.0f} µm): it would be left raw in places",
                    1000 * part.error.off_95, 1000 * *part.last_layer));
}

/// The fit, of a bent part where the points ask for it and the job allows it.
void FitPart(const ProbedPart& part, const std::vector<ProbedPoint>& points,
             const WorkpieceSettings& workpiece, const Execution& execution, RegisteredPart& result) {
  result.max_bending = workpiece.max_bending;
  result.found = Register(part, points, MakePose(workpiece.pose), execution.Threads(), execution.stop);
  result.bent = RegisterBent(part, points, result.found, execution.Threads(), execution.stop);
  if (result.bent && result.bent->largest <= workpiece.max_bending.value_or(0) &&
      result.bent->slope <= kSteepestBending)
    result.found = result.bent->found;
}

RegisteredPart Registered(const RegisterArguments& arguments, std::vector<JobInputs>& operations,
                          const Execution& execution) {
  JobInputs& inputs = operations.front();
  RefuseJob(inputs);
  for (JobInputs& each : operations) each.job.workpiece.registered.reset();  // what was found before
  const ProbedSet probed = ReadProbed(arguments);
  execution.progress.Begin(SurfaceStage(inputs), 0);
  for (JobInputs& each : operations)
    CutStepFiles(
        &each, [&](int percent) { execution.progress.Percent(percent); }, execution.stop);
  Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  const ImportResult import = ReadPart(inputs, cell).import;
  const ProbedPart part(import.mesh, inputs.job.toolpath.crease);
  const std::vector<PartPlace> face = CutPlaces(operations, import.mesh, execution.stop);
  execution.progress.End(fmt::format("{} milling points", face.size()));

  execution.progress.Begin("register", 0);
  const WorkpieceSettings& workpiece = inputs.job.workpiece;
  const Pose start = MakePose(workpiece.pose);
  RegisteredPart result;
  FitPart(part, probed.points, workpiece, execution, result);
  result.points = probed.points.size();
  result.milled = face.size();
  result.pose = AsWritten(result.found.X);
  result.tolerance = workpiece.registration_tolerance;
  result.last_layer = LeastLastLayer(operations);
  result.error = ErrorOfFace(result.found.covariance, result.found.centre, face, result.found.Bending());
  if (!face.empty()) result.worst = face[result.error.worst];
  for (const PartPlace& place : face) {
    const Vector3d bent = result.found.bending ? result.found.bending->Bent(place.position) : place.position;
    result.moved = std::max(result.moved, (result.found.X * bent - start * place.position).norm());
  }
  Judge(probed, result);
  const Pose X_WF = workpiece.frame == GivenFrame::kRobotBase ? cell.X_WB : Pose::Identity();
  cell.X_WP = X_WF * MakePose(result.pose);
  AddWorkpiece(inputs, import.mesh.triangles(), &cell);
  Propose(arguments, inputs, part, probed, face, std::move(cell), result);
  execution.progress.End(fmt::format("{} points", probed.points.size()));
  return result;
}

std::string ListText(const Vector3d& v, int decimals) {
  return fmt::format("[{}, {}, {}]", Short(v[0], decimals), Short(v[1], decimals), Short(v[2], decimals));
}

}  // namespace

std::string RegisteredPart::PoseYaml() const {
  return fmt::format("{{xyz_mm: {}, abc_deg: {}}}", ListText(pose.position, kLengthDecimals),
                     ListText(pose.abc * kDegPerRad, kAngleDecimals));
}

std::string RegisteredPart::RegisteredYaml() const {
  const auto rows = [&](int from, int to) {
    std::string numbers;
    for (int i = from; i < to; ++i)
      for (int j = 0; j <= i; ++j)
        numbers += fmt::format("{}{:.6g}", numbers.empty() ? "" : ", ", CovarianceMrad(i, j));
    return numbers;
  };
  std::string bending;
  if (found.bending) {
    std::string modes;
    for (size_t i = 0; i < found.bending->modes.size(); ++i)
      modes += fmt::format("{}{}: {}", i == 0 ? "" : ", ", kModeNames[i],
                           Short(found.bending->modes[i], kModeDecimals));
    bending = fmt::format(
        ", bending: {{origin_mm: {}, u_mm: {}, v_mm: {}, modes_mm: {{{}}}, covariance_mm_mrad: [{}]}}",
        ListText(found.bending->origin, kLengthDecimals), ListText(found.bending->u, kLengthDecimals),
        ListText(found.bending->v, kLengthDecimals), modes,
        rows(6, static_cast<int>(found.covariance.rows())));
  }
  return fmt::format("{{pose: {}, centre_mm: {}, covariance_mm_mrad: [{}]{}}}", PoseYaml(),
                     ListText(found.centre, 3), rows(0, 6), bending);
}

double RegisteredPart::CovarianceMrad(int i, int j) const {
  constexpr double kRounding = 1e-9;  // a correlation below it is what rounding leaves of none
  const auto per_mrad = [](int k) { return k >= 3 && k < 6 ? 1e3 : 1.0; };
  const ProbeMatrix& all = found.covariance;
  if (std::abs(all(i, j)) <= kRounding * std::sqrt(all(i, i) * all(j, j))) return 0;
  return all(i, j) * per_mrad(i) * per_mrad(j);
}

RegisteredPart RegisterPart(const RegisterArguments& arguments, const Execution& execution) {
  const std::vector<std::string> setups =
      SetupNames(arguments.root.Read(arguments.job), arguments.job.string());
  if (!setups.empty() && !setups.front().empty())
    throw InputError(
        {arguments.job.string()},
        fmt::format("setups: the part stands in several ways, and the points tell of one; allowed: "
                    "a job of one of them alone ({}), with its pose as workpiece.pose",
                    fmt::join(std::set<std::string>(setups.begin(), setups.end()), ", ")));
  std::vector<JobInputs> operations = LoadOperations(arguments.job, {}, arguments.root);
  return WithPlaces(operations.front(), [&] { return Registered(arguments, operations, execution); });
}

}  // namespace millpose
