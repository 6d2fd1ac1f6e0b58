// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/audit.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "audit/distance.hpp"
#include "audit/interference.hpp"
#include "base/parallel.hpp"
#include "tests/audit/kinematics.hpp"
#include "tests/audit/laws.hpp"
#include "tests/audit/motions.hpp"
#include "tests/audit/programs.hpp"
#include "tests/audit/reversals.hpp"

namespace millpose::audit {
namespace {

// Moves of the external axes are long; they keep their clearances, less what a step between positions may
// miss.
constexpr double kMoveTravel = 2, kMoveSlack = 2.5;  // mm
constexpr Real kAngleSlack = 1e-6L * kDegree;        // programs carry six decimals of a degree

class Figures {
 public:
  void Declare(const std::string& name, double bound) { verdict_.figures.push_back({name, 0, bound, ""}); }
  void Raise(const std::string& name, Real value, const std::string& where) {
    Figure& figure = Find(name);
    if (static_cast<double>(value) <= figure.value) return;
    figure.value = static_cast<double>(value);
    figure.where = where;
  }
  void Count(const std::string& name, const std::string& where) {
    Figure& figure = Find(name);
    if (figure.value++ == 0) figure.where = where;
  }
  void AddPoses(long long count) { verdict_.poses_checked += count; }
  void AddObjective() { ++verdict_.objectives_recomputed; }
  void AddExcused() { ++verdict_.bends_excused; }
  Verdict Take() { return std::move(verdict_); }

 private:
  Figure& Find(const std::string& name) {
    for (Figure& figure : verdict_.figures)
      if (figure.name == name) return figure;
    throw std::logic_error("no figure " + name);
  }
  Verdict verdict_;
};

/// Limits that couple axes; `margin` (rad) is kept from them.
void CountCoupled(const Setup& setup, const Angles& angles, Real margin, const std::string& where,
                  Figures& figures) {
  for (const Setup::Coupled& limit : setup.coupled) {
    Real sum = 0;
    for (size_t i = 0; i < 6; ++i) sum += limit.factors[i] * angles[i];
    if (sum > limit.at_most - margin + kAngleSlack)
      figures.Count("limit_violations", fmt::format("the coupled axes of {}", where));
  }
}

void AuditIndices(const Setup& setup, const Row& row, Figures& figures) {
  const Indices indices = ComputeIndices(setup, row.angles, row.normal);
  const auto compare = [&](const char* name, Real given, Real computed) {
    figures.Raise("max_index_error_relative", std::abs(given / computed - 1),
                  fmt::format("{} of point {}", name, row.point));
  };
  compare("lambda_t1", row.lambda_t1, indices.lambda_t1);
  compare("lambda_t2", row.lambda_t2, indices.lambda_t2);
  compare("lambda_n", row.lambda_n, indices.lambda_n);
  compare("mu", row.mu, indices.mu);
  compare("dexterity", row.dexterity, indices.dexterity);
  if (indices.objective > 0) compare("objective", row.objective, indices.objective);
}

Real Ratio(Real difference, Real scale) {
  if (difference == 0) return 0;
  return scale > 0 ? std::abs(difference) / scale : std::numeric_limits<Real>::infinity();
}

/// The point's own objective, and what its force moves.
void AuditForce(const Folder& folder, const Row& row, Figures& figures) {
  const std::string name = fmt::format("point {}", row.point);
  const Matrix3 c = ComplianceAt(folder.At(row.external), row.angles);
  if (const std::optional<OwnObjective> own = ObjectiveOf(folder, row, c)) {
    figures.AddObjective();
    figures.Raise("max_objective_error_relative", Ratio(row.objective - own->value, own->scale), name);
  }
  if (folder.deflected.empty() && !NeedsForces(folder.goal)) return;
  const auto stated = folder.deflected.find(row.point);
  if (stated != folder.deflected.end())
    figures.Raise("max_deflection_error_relative", DeflectionError(stated->second, row, c), name);
  else if (row.cut)
    figures.Count("missing_forces", name);
}

/// How far a point is from the workpiece once it is lowered along its normal by a layer's height.
Real OffSurface(const Folder& folder, const Row& row, Real layer) {
  const Setup& setup = folder.At(row.external);
  const auto R_PW = setup.X_WP.block<3, 3>(0, 0).transpose();
  const Vector3 place = R_PW * (ContactOf(folder, row) - setup.X_WP.block<3, 1>(0, 3));
  const Vector3 normal = R_PW * row.normal;
  if (!folder.plate) return Distance(Vector3(place - layer * normal), folder.setup.bodies.back().mesh);
  const Vector3 unbent = folder.plate->Unbent(place);
  return Distance(Vector3(unbent - layer * folder.plate->UnbentNormal(unbent, normal)), folder.unbent);
}

/// The point of a pass that is farthest from a layer above the workpiece; looks no further once that is
/// farther than `enough`.
std::pair<Real, int> FarthestOff(const Folder& folder, std::span<const Row> pass, Real layer, Real enough) {
  std::pair<Real, int> farthest{0, -1};
  for (const Row& row : pass) {
    if (!row.cut) continue;
    farthest = std::max(farthest, {OffSurface(folder, row, layer), row.point});
    if (farthest.first > enough) break;
  }
  return farthest;
}

/// Every cut point stands a layer above the workpiece, all of a pass the same one. Leads lead away.
void AuditSurface(const Folder& folder, Figures& figures) {
  const std::vector<Row>& rows = folder.rows;
  if (!folder.setup.laid) return;
  for (size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
    while (end < rows.size() && rows[end].pass == rows[begin].pass) ++end;
    const std::span pass(rows.begin() + static_cast<std::ptrdiff_t>(begin), end - begin);
    std::pair<Real, int> off{std::numeric_limits<Real>::infinity(), -1};
    for (const Real layer : folder.goal.layers) {
      const std::pair<Real, int> of = FarthestOff(folder, pass, layer, off.first);
      if (of.first < off.first) off = of;
    }
    figures.Raise("max_slice_distance_mm", off.first, fmt::format("point {}", off.second));
  }
}

void AuditRows(const Folder& folder, Figures& figures) {
  for (const Row& row : folder.rows) {
    const std::string name = fmt::format("point {}", row.point);
    if (!row.planned) continue;
    const Setup& setup = folder.At(row.external);
    const Matrix4 X_WT = Tool(setup, row.angles);
    if (setup.urdf) {
      const Matrix4 off = UrdfTool(*setup.urdf, row.angles) - X_WT;
      figures.Raise("max_urdf_error_mm", off.block<3, 1>(0, 3).norm(), name);
    }
    figures.Raise("max_tip_error_mm", (Vector3(X_WT.block<3, 1>(0, 3)) - row.position).norm(), name);
    figures.Raise("max_axis_error_deg", AngleBetween(Vector3(X_WT.block<3, 1>(0, 2)), row.axis) / kDegree,
                  name);
    AuditIndices(setup, row, figures);
    AuditForce(folder, row, figures);
    for (size_t i = 0; i < 6; ++i)
      if (row.angles[i] < setup.lower[i] - kAngleSlack || row.angles[i] > setup.upper[i] + kAngleSlack)
        figures.Count("limit_violations", fmt::format("A{} of point {}", i + 1, row.point));
    CountCoupled(setup, row.angles, setup.coupled_margin, fmt::format("point {}", row.point), figures);
    for (size_t i = 0; i < row.external.size(); ++i) {
      const ExternalAxis& axis = folder.setup.axes[i];
      if (row.external[i] < axis.lower - kAngleSlack || row.external[i] > axis.upper + kAngleSlack)
        figures.Count("limit_violations", fmt::format("{} of point {}", axis.name, row.point));
    }
  }
}

/// Commanded poses: the angles reach them, they stand beside the nominal ones by what compensation.csv says,
/// and by no more than the job allows.
void AuditCommanded(const Folder& folder, Figures& figures) {
  for (const Row& row : folder.rows) {
    if (!row.commanded) continue;
    const Setup& setup = folder.At(row.external);
    const std::string name = fmt::format("point {}", row.point);
    const Matrix4 X_WT = Tool(setup, row.commanded->angles);
    figures.Raise("max_commanded_tip_error_mm",
                  (Vector3(X_WT.block<3, 1>(0, 3)) - row.commanded->position).norm(), name);
    figures.Raise("max_commanded_axis_error_deg",
                  AngleBetween(Vector3(X_WT.block<3, 1>(0, 2)), row.commanded->axis) / kDegree, name);
    Vector3 shift = row.commanded->position - row.position;
    const auto stated = folder.compensated.find(row.point);
    if (stated == folder.compensated.end()) {
      figures.Count("missing_shifts", name);
    } else {
      // They are told as the part has them, which may stand elsewhere at each point.
      const Matrix3 R = setup.X_WP.block<3, 3>(0, 0) * folder.setup.X_WP.block<3, 3>(0, 0).transpose();
      shift -= R * stated->second.arm;
      figures.Raise("max_shift_error_mm", (shift - R * stated->second.shift).norm(), name);
    }
    figures.Raise("max_shift_excess_mm", shift.norm() - folder.goal.largest_shift, name);
    // So commanded, the arm that runs the program is where the plan has it, but for the shift.
    const Matrix4 own = Tool(folder.AsItIs(setup), row.commanded->angles);
    figures.Raise("max_own_tip_error_mm", (Vector3(own.block<3, 1>(0, 3)) - row.position - shift).norm(),
                  name);
    figures.Raise("max_own_axis_error_deg", AngleBetween(Vector3(own.block<3, 1>(0, 2)), row.axis) / kDegree,
                  name);
    for (size_t i = 0; i < 6; ++i)
      if (row.commanded->angles[i] < setup.hard_lower[i] - kAngleSlack ||
          row.commanded->angles[i] > setup.hard_upper[i] + kAngleSlack)
        figures.Count("limit_violations", fmt::format("A{} commanded at point {}", i + 1, row.point));
    CountCoupled(setup, row.commanded->angles, 0, fmt::format("commanded point {}", row.point), figures);
  }
}

/// The rows with what programs are given in place of the nominal poses.
std::vector<Row> CommandedRows(std::vector<Row> rows) {
  for (Row& row : rows) {
    if (!row.commanded) continue;
    row.position = row.commanded->position;
    row.angles = row.commanded->angles;
  }
  return rows;
}

/// A place (1) or a direction (0) of a row in the part's frame.
Vector3 OnPart(const Folder& folder, const Row& row, const Vector3& v, int is_place) {
  const Matrix4& X_WP = folder.At(row.external).X_WP;
  return X_WP.block<3, 3>(0, 0).transpose() * (v - is_place * Vector3(X_WP.block<3, 1>(0, 3)));
}

/// The way of a step on the part, mm: of the tip or, where the tool turns on the spot, of a point 300 mm up
/// its axis; where the plan chooses leans, of the contact and of a tool along the normal.
Real WayOf(const Folder& folder, const Row& from, const Row& to) {
  const auto place = [&](const Row& row) {
    return OnPart(folder, row, folder.leans ? ContactOf(folder, row) : row.position, 1);
  };
  const auto along = [&](const Row& row) {
    return OnPart(folder, row, folder.leans ? row.normal : row.axis, 0);
  };
  return std::max((place(to) - place(from)).norm(), 300 * (along(to) - along(from)).norm());
}

/// Leans keep their ranges, change no faster than they may, and are those of the axes.
void AuditLeans(const Folder& folder, const std::vector<Cut>& cuts, Figures& figures) {
  const Goal& goal = folder.goal;
  const auto outside = [](const std::array<Real, 2>& range, Real value) {
    return value < range[0] - kAngleSlack || value > range[1] + kAngleSlack;
  };
  for (const Row& row : folder.rows) {
    if (!row.lean) continue;
    figures.Raise("max_lean_error_deg", LeanError(row) / kDegree, fmt::format("point {}", row.point));
    if (outside(goal.lead, row.lean->lead) || outside(goal.tilt, row.lean->tilt))
      figures.Count("lean_violations", fmt::format("point {}", row.point));
  }
  for (const Cut& cut : cuts)
    for (size_t k = 1; k < cut.rows.size() + (cut.closed ? 1 : 0); ++k) {
      const Row &from = *cut.rows[k - 1], &to = *cut.rows[k % cut.rows.size()];
      if (!from.lean || !to.lean) continue;
      const Real most = goal.max_lean_change * WayOf(folder, from, to) + kAngleSlack;
      if (std::abs(to.lean->lead - from.lean->lead) > most ||
          std::abs(to.lean->tilt - from.lean->tilt) > most)
        figures.Count("lean_violations", fmt::format("point {} to {}", from.point, to.point));
    }
}

void AuditSteps(const Folder& folder, const std::vector<Cut>& cuts, Figures& figures) {
  const Setup& setup = folder.setup;
  for (const Cut& cut : cuts)
    for (size_t k = 1; k < cut.rows.size() + (cut.closed ? 1 : 0); ++k) {
      const Row &from = *cut.rows[k - 1], &to = *cut.rows[k % cut.rows.size()];
      const bool closing = k == cut.rows.size();  // with the full revolutions of the way round
      const Angles angles = closing ? TurnedNear(to.angles, from.angles) : to.angles;
      const Real way = WayOf(folder, from, to);
      const Real time = way / std::max(from.feed, to.feed);
      for (size_t i = 0; i < 6; ++i) {
        const Real most =
            std::min({setup.max_step[i], setup.max_step_per_mm * way, setup.max_step_speed[i] * time});
        if (angles[i] < setup.lower[i] - kAngleSlack || angles[i] > setup.upper[i] + kAngleSlack)
          figures.Count("limit_violations", fmt::format("A{} back at point {}", i + 1, to.point));
        if (std::abs(angles[i] - from.angles[i]) > most + kAngleSlack)
          figures.Count("step_violations",
                        fmt::format("A{} from point {} to {}", i + 1, from.point, to.point));
      }
      // Programs run a motion at the feed of the point that it leads to.
      for (size_t i = 0; i < from.external.size(); ++i)
        if (std::abs(to.external[i] - from.external[i]) > setup.axes[i].speed * way / to.feed + kAngleSlack)
          figures.Count("step_violations",
                        fmt::format("{} from point {} to {}", setup.axes[i].name, from.point, to.point));
    }
}

/// Half-way between points. Where the bound itself is exceeded, the points must lie too far apart for it.
void AuditHalfway(const Folder& folder, const std::vector<Cut>& cuts, Figures& figures) {
  Real largest = 0;
  for (const Cut& cut : cuts)
    for (size_t k = 1; k < cut.rows.size() + (cut.closed ? 1 : 0); ++k) {
      const Row &from = *cut.rows[k - 1], &to = *cut.rows[k % cut.rows.size()];
      const Real off = HalfwayDeviation(folder.setup, {from.angles, from.external},
                                        {TurnedNear(to.angles, from.angles), to.external});
      largest = std::max(largest, off);
      if (off <= folder.goal.max_halfway) continue;
      const Real most = MostHalfway(folder.goal, HalfwayUnchanged(folder, from, to));
      figures.Raise("max_halfway_excess_mm", off - most, fmt::format("point {} to {}", from.point, to.point));
      if (off <= most) figures.AddExcused();
    }
  if (!folder.summary) return;
  constexpr Real kLeast = 1e-3L;  // mm: below, rounding counts
  figures.Raise("max_summary_error_relative",
                std::abs(folder.summary->max_halfway - largest) / std::max(kLeast, largest),
                "continuity.halfway_deviation_max_mm");
}

/// The worst and the best of points.csv, whose rows are judged one by one.
void AuditSummary(const Folder& folder, Figures& figures) {
  if (!folder.summary) return;
  Real best = std::numeric_limits<Real>::infinity(), worst = 0;
  for (const Row& row : folder.rows)
    if (row.planned) best = std::min(best, row.objective), worst = std::max(worst, row.objective);
  for (const auto& [name, stated, own] : {std::tuple{"best", folder.summary->best_objective, best},
                                          {"worst", folder.summary->worst_objective, worst}})
    figures.Raise("max_summary_error_relative", Ratio(stated - own, worst),
                  fmt::format("stiffness.objective.{}", name));
}

void AuditMotions(const Setup& setup, const std::vector<JointMotion>& motions, const Options& options,
                  Figures& figures) {
  std::vector<std::optional<Contact>> contacts(motions.size());
  const size_t parts = static_cast<size_t>(options.threads);
  std::vector<long long> poses(parts);
  ParallelFor(parts, options.threads, {}, [&](size_t part) {
    Judge judge(setup);
    std::vector<Real> stands;
    for (size_t k = part; k < motions.size(); k += parts) {
      const JointMotion& motion = motions[k];
      if (motion.move_to && motion.from == motion.to && !motion.cutting) {
        const std::vector<Near> near =
            judge.Moving(motion.external, *motion.move_to, motion.from, kMoveSlack, kMoveTravel);
        if (!near.empty()) contacts[k] = Contact{near.front().first, near.front().second, motion.from};
        stands = *motion.move_to;
        continue;
      }
      Motion looked_at{motion.from, motion.to, motion.cutting};
      if (motion.move_to)
        looked_at.external_from = motion.external, looked_at.external_to = stands = *motion.move_to;
      else if (stands != motion.external)
        judge.Stand(stands = motion.external);
      contacts[k] = judge.Between(looked_at, options.travel_mm);
    }
    poses[part] = judge.poses();
  });
  for (const long long count : poses) figures.AddPoses(count);
  for (size_t k = 0; k < motions.size(); ++k)
    if (contacts[k])
      figures.Count("interferences",
                    fmt::format("{} and {}, {}", contacts[k]->first, contacts[k]->second, motions[k].name));
}

void AuditLinkMoveLimits(const Setup& setup, const std::vector<JointMotion>& motions, Figures& figures) {
  for (const JointMotion& motion : motions) {
    for (size_t i = 0; i < 6; ++i)
      if (motion.to[i] < setup.hard_lower[i] - kAngleSlack ||
          motion.to[i] > setup.hard_upper[i] + kAngleSlack)
        figures.Count("limit_violations", fmt::format("A{} at {}", i + 1, motion.name));
    CountCoupled(setup, motion.to, 0, motion.name, figures);
  }
}

}  // namespace

bool Verdict::Holds() const {
  return std::all_of(figures.begin(), figures.end(), [](const Figure& f) { return f.value <= f.bound; });
}

const Figure& Verdict::operator[](const std::string& name) const {
  for (const Figure& figure : figures)
    if (figure.name == name) return figure;
  throw std::out_of_range("no figure " + name);
}

Verdict Audit(const Folder& folder, const Options& options) {
  Figures figures;
  figures.Declare("max_tip_error_mm", 1e-6);
  figures.Declare("max_axis_error_deg", 1e-7);
  figures.Declare("max_slice_distance_mm", 1e-6);
  figures.Declare("limit_violations", 0);
  figures.Declare("step_violations", 0);
  if (folder.leans) {
    figures.Declare("max_lean_error_deg", 1e-7);
    figures.Declare("lean_violations", 0);
  }
  figures.Declare("max_index_error_relative", 1e-6);
  figures.Declare("max_objective_error_relative", 1e-8);
  figures.Declare("max_deflection_error_relative", 1e-8);
  figures.Declare("missing_forces", 0);
  figures.Declare("max_halfway_excess_mm", 1e-9);
  figures.Declare("max_summary_error_relative", 1e-8);
  figures.Declare("reversal_violations", 0);
  figures.Declare("max_lost_motion_error_mm", 1e-7);
  figures.Declare("interferences", 0);
  if (!folder.compensated.empty()) {
    figures.Declare("max_commanded_tip_error_mm", 1e-6);
    figures.Declare("max_commanded_axis_error_deg", 1e-7);
    figures.Declare("max_shift_excess_mm", 1e-9);
    figures.Declare("max_shift_error_mm", 1e-9);
    figures.Declare("missing_shifts", 0);
    figures.Declare("max_own_tip_error_mm", 1e-6);
    figures.Declare("max_own_axis_error_deg", 1e-7);
  }
  if (folder.setup.urdf) figures.Declare("max_urdf_error_mm", 0.01);
  for (const auto& [controller, files] : folder.programs) {
    figures.Declare("program_deviation_mm_" + controller, static_cast<double>(kPositionBound));
    figures.Declare("program_deviation_deg_" + controller, static_cast<double>(kAngleBound / kDegree));
    if (folder.setup.axes.empty()) continue;
    figures.Declare("program_deviation_external_" + controller, static_cast<double>(kExternalBound));
    figures.Declare("program_external_violations_" + controller, 0);
  }

  std::vector<Cut> cuts = CutsOf(folder.rows, folder.setup);
  AuditSurface(folder, figures);
  AuditRows(folder, figures);
  AuditSteps(folder, cuts, figures);
  AuditLeans(folder, cuts, figures);
  AuditHalfway(folder, cuts, figures);
  AuditSummary(folder, figures);
  AuditReversals(folder, {[&](const std::string& where) { figures.Count("reversal_violations", where); },
                          [&](Real off, const std::string& where) {
                            figures.Raise("max_lost_motion_error_mm", off, where);
                          }});
  std::vector<JointMotion> motions = CutMotions(cuts), gaps;
  const std::vector<Row> commanded = CommandedRows(folder.rows);
  if (!folder.compensated.empty()) {
    AuditCommanded(folder, figures);
    cuts = CutsOf(commanded, folder.setup);
    if (folder.own_arm) motions.clear();  // that arm runs no nominal poses
    std::ranges::move(CutMotions(cuts), std::back_inserter(motions));
  }
  for (const auto& [controller, files] : folder.programs) {
    const std::vector<Target> targets = ReadProgram(controller, files, folder.setup);
    const Deviation deviation = Compare(targets, cuts, folder.setup);
    figures.Raise("program_deviation_mm_" + controller, deviation.position, deviation.where);
    figures.Raise("program_deviation_deg_" + controller, deviation.angle / kDegree, deviation.where);
    if (!folder.setup.axes.empty()) {
      figures.Raise("program_deviation_external_" + controller, deviation.external, deviation.external_where);
      for (const std::string& where : ExternalViolations(controller, targets, cuts, folder.setup))
        figures.Count("program_external_violations_" + controller, where);
    }
    // The one that may be in joint space throughout.
    const bool joints =
        std::ranges::all_of(targets, [](const Target& target) { return target.angles.has_value(); });
    if (controller == "linuxcnc" && joints && !targets.empty()) gaps = LinkMotions(targets, cuts);
  }
  if (gaps.empty()) gaps = PlannedLinkMotions(folder, cuts);
  AuditLinkMoveLimits(folder.setup, gaps, figures);
  motions.insert(motions.end(), gaps.begin(), gaps.end());
  AuditMotions(folder.AsItIs(folder.setup), motions, options, figures);
  return figures.Take();
}

std::string ToJson(const Verdict& verdict) {
  nlohmann::ordered_json json;
  nlohmann::ordered_json bounds, broken = nlohmann::ordered_json::object();
  for (const Figure& figure : verdict.figures) {
    json[figure.name] = figure.value;
    bounds[figure.name] = figure.bound;
    if (figure.value > figure.bound) broken[figure.name] = figure.where;
  }
  json["poses_checked"] = verdict.poses_checked;
  json["objectives_recomputed"] = verdict.objectives_recomputed;
  json["bends_excused"] = verdict.bends_excused;
  json["bounds"] = bounds;
  json["broken"] = broken;
  return json.dump(2) + "\n";
}

}  // namespace millpose::audit
