// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/plausible.hpp"

#include <Eigen/Geometry>

#include "base/decompositions.hpp"
#include "base/shown.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "job/locate.hpp"
#include "machine/robot/kinematics.hpp"
#include "machine/stiffness/pose_stiffness.hpp"

namespace millpose {
namespace {

// mm of feed per tooth: below it edges rub, above it no cutter of a machining centre works. Kienzle's law is
// measured well within.
constexpr double kLeastChip = 0.002, kMostChip = 1;
constexpr double kMostDeflection = 5;  // mm at home: more is a slip in force or stiffness, or no milling
// Of the arm's length, the longest side of a mesh on a link or tool: from a cap to a whole arm as one mesh.
constexpr double kLeastLink = 1.0 / 500, kMostLink = 1.5;
// The same of what stands beside the arm: from a clamp's pin to a hall.
constexpr double kLeastBeside = 1.0 / 2000, kMostBeside = 40;

Eigen::AlignedBox3d BoxOf(const Shape& shape) {
  const auto about = [](double x, double y, double z) {
    const Eigen::Vector3d half(x, y, z);
    return Eigen::AlignedBox3d(-half, half);
  };
  const auto around = [](const std::vector<Eigen::Vector3d>& points) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : points) box.extend(p);
    return box;
  };
  if (const auto* box = std::get_if<Box>(&shape))
    return about(box->size.x() / 2, box->size.y() / 2, box->size.z() / 2);
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return about(sphere->radius, sphere->radius, sphere->radius);
  if (const auto* c = std::get_if<Cylinder>(&shape)) return about(c->radius, c->radius, c->length / 2);
  if (const auto* c = std::get_if<Capsule>(&shape))
    return about(c->radius, c->radius, c->radius + c->length / 2);
  if (const auto* c = std::get_if<Cone>(&shape)) {
    const double radius = std::max(c->radius_bottom, c->radius_top);
    return about(radius, radius, c->length / 2);
  }
  if (const auto* convex = std::get_if<Convex>(&shape)) return around(convex->points);
  return around(std::get<Triangles>(shape).vertices);
}

/// A body of the cell file, or of the URDF that it names, with what became of it.
struct GivenBody {
  const BodySettings& settings;
  const Body& body;
  std::string key;

  bool OnLink() const { return body.mount == Mount::kLink; }
  std::string Mounted() const { return OnLink() ? WordOf(kLinkWords, body.link) : "the tool"; }
};

std::vector<GivenBody> GivenBodies(const Judged& judged) {
  const std::vector<BodySettings>& given = judged.settings.bodies;
  const size_t stack = judged.settings.tool.stack.size();  // comes first in the cell
  std::vector<GivenBody> bodies;
  for (size_t i = 0; i < given.size(); ++i)
    bodies.push_back({given[i], judged.cell.bodies[stack + i],
                      given[i].from_urdf ? "arm.urdf" : fmt::format("bodies[{}]", i)});
  return bodies;
}

void JudgeFarBodies(const Judged& judged, std::vector<Doubt>& doubts) {
  const double arm = ArmLength(judged.cell.arm);
  std::vector<std::string> unused = judged.settings.far_bodies;
  for (const GivenBody& given : GivenBodies(judged)) {
    if (!given.OnLink()) continue;
    const Eigen::Vector3d link_in_body = given.body.X_MG.inverse().translation();
    const double away = BoxOf(given.body.shape).exteriorDistance(link_in_body);
    if (away <= arm) continue;
    if (std::erase(unused, given.body.name) > 0) continue;
    doubts.push_back({given.settings.from_urdf ? given.key : given.key + ".pose.xyz_mm", true,
                      fmt::format("{} lies {:.6g} mm from {}; the arm is {:.6g} mm long; usual: on its link, "
                                  "which nothing sees touch otherwise (what is meant stands in "
                                  "interference.far_bodies)",
                                  Shown(given.body.name), away, given.Mounted(), arm),
                      true});
  }
  for (const std::string& name : unused)
    doubts.push_back({"interference.far_bodies", true,
                      fmt::format("given {}; no body of that name lies farther from its link than the arm is "
                                  "long",
                                  Shown(name)),
                      true});
}

/// The units of a mesh file with which it would be as large as is usual.
std::string FittingUnits(double extent, double unit, double least, double most) {
  constexpr std::array<std::pair<const char*, double>, 4> kUnits{
      {{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"m", 1000}}};
  std::string fits;
  for (const auto& [name, size] : kUnits)
    if (const double of_unit = extent / unit * size; of_unit >= least && of_unit <= most)
      fits += (fits.empty() ? "; it would be with unit: " : " or ") + std::string(name);
  return fits;
}

void JudgeBodySizes(const Judged& judged, std::vector<Doubt>& doubts) {
  const double arm = ArmLength(judged.cell.arm);
  for (const GivenBody& given : GivenBodies(judged)) {
    const bool moves = given.OnLink() || given.body.mount == Mount::kTool;
    const bool mesh = given.settings.shape.kind == ShapeKind::kMesh;
    const double least = mesh ? arm * (moves ? kLeastLink : kLeastBeside) : 0;
    const double most = arm * (moves ? kMostLink : kMostBeside);
    const double extent = BoxOf(given.body.shape).sizes().maxCoeff();
    if (extent >= least && extent <= most) continue;
    const std::string key = given.settings.from_urdf ? given.key
                            : mesh                   ? given.key + ".shape.mesh.unit"
                                                     : given.key + ".shape";
    doubts.push_back(
        {key, true,
         fmt::format("{}{} is {:.6g} mm long; the arm is {:.6g} mm long; usual{}: {:.3g} to {:.6g} mm{}",
                     Shown(given.body.name),
                     mesh ? fmt::format(" ({})", Shown(given.settings.shape.mesh_file)) : "", extent, arm,
                     moves ? " on " + given.Mounted() : "", least, most,
                     mesh ? FittingUnits(extent, given.settings.shape.unit, least, most) : "")});
  }
}

void JudgeTools(const Judged& judged, std::vector<Doubt>& doubts) {
  const double arm = ArmLength(judged.cell.arm);
  const auto judge = [&](const ToolSettings& tool, const std::string& key) {
    double length = 0;
    for (const ToolPartSettings& part : tool.stack) length += part.length;
    if (length > arm)
      doubts.push_back({key + ".stack", true,
                        fmt::format("{} is {:.6g} mm long; the arm is {:.6g} mm long; usual: a stack shorter "
                                    "than the arm",
                                    Shown(tool.name), length, arm)});
    if (tool.tip.norm() > arm)
      doubts.push_back(
          {key + ".tip_in_flange_mm", true,
           fmt::format("the tip of {} lies {:.6g} mm from the flange; the arm is {:.6g} mm long; "
                       "usual: nearer than the arm is long",
                       Shown(tool.name), tool.tip.norm(), arm)});
  };
  const std::vector<ToolSettings>& tools = judged.settings.tools;
  for (size_t i = 0; i < tools.size(); ++i) judge(tools[i], fmt::format("tools[{}]", i));
  if (tools.empty()) judge(judged.settings.tool, "tool");
}

void JudgeStepover(const Judged& judged, std::vector<Doubt>& doubts) {
  if (!judged.job || !judged.part) return;
  const double step = judged.job->toolpath.stepover, longest = judged.part->maxCoeff();
  if (!(longest > 0) || longest >= step) return;
  doubts.push_back({"toolpath.stepover_mm", false,
                    fmt::format("given {:.6g}; the part is {:.4g} x {:.4g} x {:.4g} mm; usual: a step-over "
                                "smaller than the part",
                                step, judged.part->x(), judged.part->y(), judged.part->z())});
}

void JudgeFeedPerTooth(const Judged& judged, std::vector<Doubt>& doubts) {
  if (!judged.job || !judged.job->cutting || judged.job->spindle_speed == 0) return;
  const JobSettings& job = *judged.job;
  const double chip = job.feed / (job.spindle_speed * job.cutting->teeth);
  if (chip >= kLeastChip && chip <= kMostChip) return;
  doubts.push_back(
      {"process.feed_mm_min", false,
       fmt::format("{:.6g} mm/min at {:.6g} rev/min and {} teeth are {:.3g} mm a tooth; usual: "
                   "{} to {} mm, which the force model holds for",
                   60 * job.feed, 60 * job.spindle_speed, job.cutting->teeth, chip, kLeastChip, kMostChip),
       !std::isfinite(chip)});
}

/// What the force bends at home, in the direction in which the arm is softest, mm.
double DeflectionAtHome(const Judged& judged, double force) {
  const Matrix6 C = EvaluatePose(judged.cell.arm, judged.cell.home, judged.cell.X_FT.translation(),
                                 Eigen::Vector3d::UnitZ(), judged.settings.characteristic_length,
                                 MakeCompliancesAtHome(judged.settings))
                        .C;
  return force * EigenOfSymmetric3(C.topLeftCorner<3, 3>()).values.maxCoeff();
}

void JudgeForce(const Judged& judged, std::vector<Doubt>& doubts) {
  if (!judged.heaviest) return;
  const double mean = judged.heaviest->mean.norm();
  if (!std::isfinite(mean) || !std::isfinite(judged.heaviest->peak)) {
    doubts.push_back(
        {"process.cutting", false,
         fmt::format("the cutting force is no finite number; usual: {} to {} mm of feed per tooth",
                     kLeastChip, kMostChip),
         true});
    return;
  }
  const double deflection = DeflectionAtHome(judged, mean);
  if (deflection <= kMostDeflection) return;
  doubts.push_back({"process.cutting", false,
                    fmt::format("the heaviest cut's {:.4g} N bend the arm by {:.3g} mm at home; usual: less "
                                "than {} mm; look at feed, depth and arm.joint_stiffness_Nm_per_rad",
                                mean, deflection, kMostDeflection)});
}

/// The table: one row each.
constexpr std::array kRows{&JudgeFarBodies, &JudgeBodySizes,    &JudgeTools,
                           &JudgeStepover,  &JudgeFeedPerTooth, &JudgeForce};

std::vector<std::string> Told(const InputError& located, const std::vector<Doubt>& doubts) {
  std::vector<Problem> refused;
  std::vector<std::string> told;
  for (size_t i = 0; i < located.problems().size(); ++i) {
    const Problem& problem = located.problems()[i];
    if (i < doubts.size() && doubts[i].refused) refused.push_back(problem);
    told.push_back(ToString(problem.place) + ": " + problem.message);
  }
  if (!refused.empty()) throw InputError(std::move(refused));
  return told;
}

InputError AsError(const std::vector<Doubt>& doubts, const std::string& cell_file,
                   const std::string& job_file) {
  std::vector<Problem> problems;
  for (const Doubt& doubt : doubts)
    problems.push_back({{doubt.of_cell ? cell_file : job_file}, doubt.key + ": " + doubt.text});
  return InputError(std::move(problems));
}

}  // namespace

std::vector<Doubt> DoubtsOf(const Judged& judged) {
  std::vector<Doubt> doubts;
  for (const auto row : kRows) row(judged, doubts);
  // Those that end everything first: only so many are told.
  std::ranges::stable_partition(doubts, [](const Doubt& doubt) { return doubt.refused; });
  return doubts;
}

std::vector<std::string> TellDoubts(const std::vector<Doubt>& doubts, const JobInputs& inputs) {
  if (doubts.empty()) return {};
  return Told(Located(AsError(doubts, inputs.cell.file, inputs.job.file), inputs), doubts);
}

std::vector<std::string> TellDoubts(const std::vector<Doubt>& doubts, const CellSettings& cell) {
  return Told(LocatedInCell(AsError(doubts, cell.file, ""), cell), doubts);
}

}  // namespace millpose
