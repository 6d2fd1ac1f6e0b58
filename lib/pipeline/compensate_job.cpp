// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/compensate_job.hpp"

#include <set>

#include "base/csv.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/trig.hpp"
#include "compensation/gain.hpp"
#include "path/cut_check.hpp"
#include "path/job_planner.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/job_engagement.hpp"
#include "robot/angles.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Measured forces, by point, in W.
class MeasuredForces {
 public:
  MeasuredForces(const JobInputs& inputs, const PlanResult& plan)
      : file_(inputs.job.force_file),
        table_(ReadCsv(inputs.force_bytes, file_,
                       {{"point", "x_mm", "y_mm", "z_mm", "force_x_N", "force_y_N", "force_z_N"}, {}})),
        plan_(plan) {}

  PointForces Read() {
    PointForces forces;
    std::vector<const PlannedPoint*> points;
    std::vector<Vector3d*> places;
    for (const PassResult& pass : plan_.passes) forces.emplace_back(pass.points.size(), Vector3d::Zero());
    for (size_t p = 0; p < plan_.passes.size(); ++p)
      for (size_t i = 0; i < plan_.passes[p].points.size(); ++i) {
        points.push_back(&plan_.passes[p].points[i]);
        places.push_back(&forces[p][i]);
      }
    std::vector<char> given(points.size(), 0);
    for (size_t row = 0; row < table_.size(); ++row) {
      const double number = table_.At(row, "point");
      if (number != std::floor(number) || number < 0 || number >= static_cast<double>(points.size())) {
        Add(row, fmt::format("point: given {}; allowed: 0 to {}, the points of this plan", number,
                             points.size() - 1));
        continue;
      }
      const auto at = static_cast<size_t>(number);
      if (std::exchange(given[at], 1) != 0) Add(row, fmt::format("point {} is given twice", at));
      CheckPlace(row, at, points[at]->point);
      const Vector3d force = Three(row, {"force_x_N", "force_y_N", "force_z_N"});
      if (force.norm() > kMostForce)
        Add(row, fmt::format("a force of {:.6g} N; allowed: up to {} N", force.norm(), kMostForce));
      *places[at] = plan_.X_WP.linear() * force;
    }
    for (size_t at = 0; at < points.size() && problems_.size() < kMostProblems; ++at)
      if (given[at] == 0 && points[at]->skip == Obstacle::kNone && points[at]->point.kind == PointKind::kCut)
        problems_.push_back({{file_}, fmt::format("point {} is cut and has no row", at)});
    if (!problems_.empty()) throw InputError(std::move(problems_));
    return forces;
  }

 private:
  static constexpr double kMostForce = 1e6, kSamePlace = 0.01;  // N, mm
  static constexpr size_t kMostProblems = 100;

  void Add(size_t row, std::string message) {
    if (problems_.size() < kMostProblems)
      problems_.push_back({{file_, table_.line(row)}, std::move(message)});
  }

  Vector3d Three(size_t row, const std::array<const char*, 3>& columns) const {
    return {table_.At(row, columns[0]), table_.At(row, columns[1]), table_.At(row, columns[2])};
  }

  void CheckPlace(size_t row, size_t number, const MillingPoint& point) {
    const double off = (Three(row, {"x_mm", "y_mm", "z_mm"}) - point.position).norm();
    if (off > kSamePlace)
      Add(row, fmt::format("point {} of this plan is {:.3f} mm from x_mm, y_mm, z_mm; allowed: {} mm: the "
                           "forces were measured on another plan",
                           number, off, kSamePlace));
  }

  std::string file_;
  CsvTable table_;
  const PlanResult& plan_;
  std::vector<Problem> problems_;
};

/// Forces are worked out for the feeds that passes were laid with: Kienzle's law takes them to those that the
/// joints can hold.
void ScaleToFeeds(const JobInputs& inputs, const std::vector<std::vector<double>>& planned_feeds,
                  const PlanResult& plan, PointForces& forces) {
  const double exponent = 1 - ChipExponent(inputs.job);
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t i = 0; i < plan.passes[p].points.size(); ++i) {
      const double feed = plan.passes[p].points[i].point.feed_rate;
      if (feed < planned_feeds[p][i]) forces[p][i] *= Pow(feed / planned_feeds[p][i], exponent);
    }
}

/// A straight motion of the tool between commanded poses, or to or from one.
struct Line {
  size_t pass, piece;
  Joints from, to;
  double share = 1;  ///< of the cell's clearances
};

std::vector<Line> LinesOf(const PlanResult& plan) {
  std::vector<Line> lines;
  const auto commanded = [](const PlannedPoint& point) {
    return point.compensation ? point.compensation->q : point.q;
  };
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t k = 0; k < plan.passes[p].pieces.size(); ++k) {
      const Piece& piece = plan.passes[p].pieces[k];
      const auto& points = plan.passes[p].points;
      const auto add = [&](size_t from, size_t to) {
        if (points[from].compensation && points[to].compensation)
          lines.push_back({p, k, commanded(points[from]), commanded(points[to])});
      };
      for (auto i = static_cast<size_t>(piece.first); i < static_cast<size_t>(piece.last); ++i) add(i, i + 1);
      if (piece.closed) add(static_cast<size_t>(piece.last), static_cast<size_t>(piece.first));
    }
  const auto ends = GapEnds(plan.home, plan.passes);
  for (size_t g = 0; g < std::min(plan.gaps.size(), ends.size()); ++g) {
    const Gap& gap = plan.gaps[g];
    if (!gap.planned || gap.joints.empty()) continue;
    const auto add = [&](int pass, int number, bool entry) {
      if (pass < 0) return;
      const auto p = static_cast<size_t>(pass);
      const PassResult& own = plan.passes[p];
      const auto piece = std::ranges::find(own.pieces, number, &Piece::piece);
      const auto k = static_cast<size_t>(piece - own.pieces.begin());
      const int at = entry || piece->closed ? piece->first : piece->last;
      const Joints q = commanded(own.points[static_cast<size_t>(at)]);
      if (entry)
        lines.push_back({p, k, gap.joints.back(), q, gap.clearance_share});
      else
        lines.push_back({p, k, q, gap.joints.front(), gap.clearance_share});
    };
    add(gap.from_pass, gap.from_piece, false);
    add(gap.to_pass, gap.to_piece, true);
  }
  return lines;
}

/// Pieces whose commanded poses are not free run at their nominal ones.
std::vector<std::string> KeepFree(const World& world, double resolution, const Execution& execution,
                                  PlanResult& plan) {
  const Carrier carrier{plan.arm, plan.X_WB, plan.X_FT};
  const std::vector<Line> lines = LinesOf(plan);
  std::vector<std::string> found(lines.size());
  ParallelFor(lines.size(), execution.Threads(), execution.stop, [&](size_t i) {
    Checker checker(world, lines[i].share);
    if (const auto problem =
            CheckCut(checker, carrier, lines[i].from, Beside(lines[i].from, lines[i].to), resolution))
      found[i] = Describe(checker, *problem);
    execution.progress.Advance(1);
  });
  std::vector<std::string> findings;
  std::set<std::pair<size_t, size_t>> told;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (found[i].empty() || !told.emplace(lines[i].pass, lines[i].piece).second) continue;
    PassResult& pass = plan.passes[lines[i].pass];
    LeaveNominal(pass, pass.pieces[lines[i].piece]);
    findings.push_back(fmt::format("pass {} piece {} is not compensated: where it is commanded, {}",
                                   pass.pass, pass.pieces[lines[i].piece].piece, found[i]));
  }
  return findings;
}

void CheckWeight(const JobSettings& job, const CellSettings& cell, std::vector<Problem>& problems) {
  if (!job.compensation.weight) return;
  if (cell.arm.absolute_accuracy)
    problems.push_back({{job.file},
                        fmt::format("compensation.weight: given true, but the controller of cell {} does it "
                                    "already (arm.absolute_accuracy: true)",
                                    cell.name)});
  if (!cell.gravity)
    problems.push_back(
        {{job.file},
         fmt::format("compensation.weight: given true; cell {} has no stiffness.gravity, which says what "
                     "weighs how much and in which pose the workpiece's frame was measured",
                     cell.name)});
}

}  // namespace

std::vector<Problem> CheckCompensation(const JobSettings& job, const CellSettings& cell) {
  std::vector<Problem> problems;
  CheckWeight(job, cell, problems);
  const bool on = job.compensation.deflection != TakeOut::kOff || job.compensation.weight;
  if (on && cell.stiffness_at != StiffnessOrigin::kToolTip)
    problems.push_back({{job.file},
                        fmt::format("compensation: needs stiffness at the tool tip; cell {} gives "
                                    "stiffness.at: flange",
                                    cell.name)});
  return problems;
}

CompensationOptions MakeCompensationOptions(const JobSettings& job, const CellSettings& cell) {
  const CompensationSettings& from = job.compensation;
  CompensationOptions options;
  options.deflection = from.deflection;
  options.share = from.shrink;
  options.force = {0.01 * job.force_uncertainty_percent, DegToRad(job.force_direction_deg)};
  options.stiffness.joints.setConstant(kStiffnessUncertainty);
  if (!cell.arm.stiffness_uncertainty.isZero(0.0)) options.stiffness.joints = cell.arm.stiffness_uncertainty;
  if (from.stiffness_uncertainty) options.stiffness.joints.setConstant(*from.stiffness_uncertainty);
  options.stiffness.beside = from.stiffness_uncertainty.value_or(kStiffnessUncertainty);
  options.most = from.most;
  options.which = from.layers;
  options.layers = LayerOffsets(job.toolpath.layers).size();
  options.cutter_radius = cell.tool.cutter_diameter / 2;
  options.beside = MakeCompliances(cell);
  if (from.weight) {
    const Arm arm = MakeArm(cell.arm);
    const Vector3d tip = cell.tool.tip;
    options.weight = [model = *MakeGravity(cell), arm, tip](const Joints& q) {
      return GravityDeflection(arm, q, model.reference, tip, model.masses, model.counterbalance,
                               model.gravity);
    };
  }
  return options;
}

std::vector<std::vector<double>> FeedsOf(const PlanResult& plan) {
  std::vector<std::vector<double>> feeds;
  for (const PassResult& pass : plan.passes) {
    std::vector<double>& own = feeds.emplace_back();
    for (const PlannedPoint& point : pass.points) own.push_back(point.point.feed_rate);
  }
  return feeds;
}

CompensationNotes CompensateJob(const JobInputs& inputs, const World& world,
                                const std::vector<std::vector<double>>& planned_feeds,
                                const Execution& execution, PlanResult& plan) {
  const CompensationOptions options = MakeCompensationOptions(inputs.job, inputs.cell);
  if (!IsOn(options)) return {};
  PointForces forces = ForcesOf(plan);
  if (!inputs.job.force_file.empty())
    forces = MeasuredForces(inputs, plan).Read();
  else if (inputs.job.cutting)
    ScaleToFeeds(inputs, planned_feeds, plan, forces);
  const CompensationCounts counts = Compensate(options, forces, plan);
  CompensationNotes notes;
  execution.progress.Begin("compensation", LinesOf(plan).size());
  notes.findings = KeepFree(world, inputs.job.swept_resolution, execution, plan);
  notes.remains = MedianRemains(options, plan);
  execution.progress.End(fmt::format("{} points shifted", counts.shifted));
  if (counts.cut > 0)
    notes.warnings.push_back(fmt::format(
        "compensation: {} shifts are cut to {:.6g} mm (compensation.max_mm), the largest would be "
        "{:.4f} mm; compensation.csv names the points",
        counts.cut, options.most, counts.largest_cut));
  if (counts.unreached > 0)
    notes.findings.push_back(
        fmt::format("compensation: {} points keep their nominal poses, the arm does not reach the others",
                    counts.unreached));
  return notes;
}

}  // namespace millpose
