// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/cell_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "job/workpiece.hpp"
#include "machine/robot/joint_chain.hpp"
#include "machine/robot/kinematics.hpp"
#include "run/init/sample_cells.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kHead =
    "# Written by `millpose init`; it can be planned as it is. What the program could not know is marked "
    "GUESS:\n"
    "# measure or replace it before a program goes to a machine. Keys: docs/yaml-reference.md.\n";

/// What to say above keys of a sample cell, which stands for an arm and not for a plant.
struct Remark {
  const char* key;
  const char* text;
};
constexpr Remark kRemarks[] = {
    {"  joint_stiffness_Nm_per_rad:",
     "  # GUESS: the stiffness of this very arm. Identify it (docs/identification.md) before deflections are "
     "believed.\n"},
    {"base_in_world:", "# GUESS: the world is the robot's base. Measure where the base is in yours.\n"},
    {"home_deg:", "# GUESS: where programs begin and end. Take your cell's own.\n"},
    {"tool:",
     "# GUESS: spindle, holder and cutter. Measure the tip in the flange, its axis, and the real stack; a "
     "stack too\n# short hides collisions.\n"},
    {"bodies:",
     "# GUESS: the list holds no fixture, table, fence or cable. Add all that the arm could touch.\n"},
    {"controllers:",
     "# GUESS: tool and base numbers, outputs of the spindle. Compare with the controller (docs/krl.md,\n"
     "# docs/sinumerik.md, docs/linuxcnc.md).\n"},
};

std::string Number(double value, double step) {
  return ShortestNumber(
      std::round(value / step) * step == 0 ? 0 : std::round(value / step) / std::round(1 / step));
}

std::string Vector(const Vector3d& v, double step) {
  return fmt::format("[{}, {}, {}]", Number(v.x(), step), Number(v.y(), step), Number(v.z(), step));
}

/// Text as a YAML scalar that holds any character of one line.
std::string Quoted(const std::string& text) {
  const bool plain = !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '.' || c == '/' || c == '-';
  }) && (std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '/' || text[0] == '.');
  if (plain) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

/// Links that could be the flange: six joints move between the base and them.
class Links {
 public:
  explicit Links(const UrdfModel& model) : model_(model) {
    for (const UrdfJoint& joint : model.joints) above_[joint.child] = &joint;
  }

  std::string Base(const std::string& given) const {
    if (!given.empty()) return given;  // checked where the chain is looked for
    std::vector<std::string> roots;
    for (const UrdfLink& link : model_.links)
      if (!above_.contains(link.name)) roots.push_back(link.name);
    for (const char* usual : {"base_link", "base"})
      for (const UrdfLink& link : model_.links)
        if (link.name == usual) return usual;
    if (roots.size() == 1) return roots[0];
    if (roots.empty()) throw InputError({model_.file}, "every link has a parent: the joints form a ring");
    throw InputError({model_.file}, fmt::format("has {} links without a parent; say which is the base: "
                                                "--base-link, one of {}",
                                                roots.size(), fmt::join(roots, ", ")));
  }

  std::string Flange(const std::string& given, const std::string& base) const {
    if (!given.empty()) return given;
    std::vector<std::string> found;
    std::set<std::string> parents;
    for (const UrdfJoint& joint : model_.joints) parents.insert(joint.parent);
    CheckNumber(base);
    for (const UrdfLink& link : model_.links)
      if (MovingJoints(base, link.name) == 6) found.push_back(link.name);
    for (const char* usual : {"tool0", "flange"})
      if (std::ranges::find(found, usual) != found.end()) return usual;
    std::vector<std::string> ends;
    for (const std::string& name : found)
      if (!parents.contains(name)) ends.push_back(name);
    if (ends.size() == 1) return ends[0];
    throw InputError(
        {model_.file},
        fmt::format("has several links that could be the flange; say which: --flange-link, one of {}",
                    fmt::join(found, ", ")));
  }

 private:
  /// Refuses what is no arm with six axes by what it is: the longest row of joints that move by themselves.
  void CheckNumber(const std::string& base) const {
    int most = -1;
    std::string end;
    for (const UrdfLink& link : model_.links)
      if (const int moving = MovingJoints(base, link.name); moving > most) most = moving, end = link.name;
    if (most == 6 || (most > 6 && IsUsual(base))) return;
    std::vector<std::string> names;
    for (std::string at = end; at != base; at = above_.at(at)->parent)
      if (above_.at(at)->type != UrdfJoint::Type::kFixed)
        names.insert(names.begin(), above_.at(at)->name + (above_.at(at)->mimic ? ", a mimic" : ""));
    throw InputError(
        {model_.file},
        fmt::format("{} joints move between '{}' and '{}'{}; allowed: arms with six, or another "
                    "--base-link or --flange-link",
                    most, base, end, names.empty() ? "" : fmt::format(" ({})", fmt::join(names, ", "))));
  }

  /// Whether tool0 or flange stands behind six joints: what moves beyond is a gripper.
  bool IsUsual(const std::string& base) const {
    return std::ranges::any_of(model_.links, [&](const UrdfLink& link) {
      return (link.name == "tool0" || link.name == "flange") && MovingJoints(base, link.name) == 6;
    });
  }

  int MovingJoints(const std::string& base, std::string link) const {
    int moving = 0;
    for (size_t steps = 0; steps <= model_.joints.size(); ++steps) {
      if (link == base) return moving;
      const auto found = above_.find(link);
      if (found == above_.end()) return -1;
      moving += found->second->type != UrdfJoint::Type::kFixed;
      link = found->second->parent;
    }
    return -1;
  }

  const UrdfModel& model_;
  std::map<std::string, const UrdfJoint*> above_;
};

/// Refuses a base that is no link before flanges are looked for behind it.
void CheckLink(const UrdfModel& model, const std::string& name) {
  std::vector<std::string> names;
  for (const UrdfLink& link : model.links) names.push_back(link.name);
  if (std::ranges::find(names, name) != names.end()) return;
  const std::string near = NearestName(name, names);
  throw InputError({model.file},
                   fmt::format("--base-link: given {}; allowed: {}{}", name, fmt::join(names, ", "),
                               near.empty() ? "" : "; nearest: " + near));
}

/// Folders that package:// names of meshes stand for, where one can be found beside or above the URDF.
std::map<std::string, fs::path> FindPackages(const UrdfModel& model, const fs::path& urdf) {
  constexpr std::string_view kPackage = "package://";
  std::map<std::string, fs::path> found;
  for (const UrdfLink& link : model.links)
    for (const UrdfShape& shape : link.collisions) {
      if (!shape.mesh_file.starts_with(kPackage)) continue;
      const std::string rest = shape.mesh_file.substr(kPackage.size());
      const size_t slash = std::min(rest.find('/'), rest.size());
      const std::string name = rest.substr(0, slash);
      if (found.contains(name) || slash == rest.size()) continue;
      for (fs::path up = urdf.parent_path();; up = up.parent_path()) {
        for (const fs::path& folder : {up / name, up})
          if (!found.contains(name) && Exists(folder / rest.substr(slash + 1))) found[name] = folder;
        if (found.contains(name) || up == up.parent_path()) break;
      }
    }
  return found;
}

/// The tool of a first cell: a spindle at a right angle to the flange, as long as suits the arm.
struct FirstTool {
  double out, down;  ///< of the tip from the flange, across and along axis 6, mm
  double diameter, cutting, length, holder_diameter, holder_length, spindle_diameter, spindle_length, bracket;
};
FirstTool ToolFor(double reach) {
  if (reach > 1800) return {250, 250, 20, 40, 60, 63, 60, 160, 320, 200};
  return {150, 70, 8, 25, 40, 40, 30, 80, 170, 60};
}

std::string ToolText(const FirstTool& tool, const Pose& X_FE) {
  const Pose X_EF = X_FE.inverse(Eigen::Isometry);
  const Vector3d middle = X_EF * Vector3d(0, 0, tool.bracket / 2);
  const double cut = tool.diameter;
  std::string text = kRemarks[3].text;
  text += fmt::format(
      "tool:\n  name: spindle_d{0}\n  tip_in_flange_mm: {1}\n  axis_in_flange: {2}                # from tip "
      "to holder\n"
      "  x_in_flange: {3}\n"
      "  cutter: {{shape: flat, diameter_mm: {0}, cutting_length_mm: {4}}}\n  stack:                         "
      "          "
      "# from the tip upwards, about the tool axis\n",
      cut, Vector(X_EF * Vector3d(-tool.out, 0, tool.down), 1e-3),
      Vector(X_EF.linear() * Vector3d::UnitX(), 1e-6), Vector(X_EF.linear() * Vector3d::UnitZ(), 1e-6),
      tool.cutting);
  text += fmt::format(
      "    - {{name: cutter, class: cutter, length_mm: {}, diameter_mm: {}}}\n"
      "    - {{name: holder, class: holder, length_mm: {}, diameter_mm: {}}}\n"
      "    - {{name: spindle, class: spindle, length_mm: {}, diameter_mm: {}}}\n",
      tool.length, cut, tool.holder_length, tool.holder_diameter, tool.spindle_length, tool.spindle_diameter);
  text += kRemarks[4].text;
  return text + fmt::format(
                    "bodies:\n  - {{name: bracket, class: spindle, mount: link6, shape: {{sphere: "
                    "{{diameter_mm: {}}}}}, pose: {{xyz_mm: {}}}}}\n",
                    tool.bracket, Vector(middle, 1e-3));
}

/// What limits and speeds a URDF leaves open; empty where it says all.
std::string MissingBounds(const JointChain& chain) {
  std::vector<std::string> limits, speeds;
  bool limits_open = false, speeds_open = false;
  for (const JointChain::Joint& joint : chain.joints) {
    limits_open |= !joint.limited;
    speeds_open |= joint.speed <= 0;
    const double lower = joint.limited ? RadToDeg(joint.lower) : -350,
                 upper = joint.limited ? RadToDeg(joint.upper) : 350;
    limits.push_back(fmt::format("[{}, {}]", Number(lower, 1e-4), Number(upper, 1e-4)));
    speeds.push_back(joint.speed > 0 ? Number(RadToDeg(joint.speed), 1e-3) : "60");
  }
  std::string text;
  if (limits_open)
    text += fmt::format(
        "  # GUESS: the URDF leaves limits open; ±350° stands there. Take the maker's.\n  limits_deg: [{}]\n",
        fmt::join(limits, ", "));
  if (speeds_open)
    text += fmt::format(
        "  # GUESS: the URDF leaves speeds open; 60 deg/s stands there. Take the maker's.\n  speeds_deg_s: "
        "[{}]\n",
        fmt::join(speeds, ", "));
  return text;
}

/// A pose with the arm up and forward that its limits allow, in the arm's own angles.
Joints FindHome(const Arm& arm, const JointChain& chain) {
  constexpr double kMargin = DegToRad(5);
  const bool parallel = arm.family == ArmFamily::kParallelAxes;
  Joints best = Joints::Zero();
  double best_miss = std::numeric_limits<double>::max();
  for (const double turn : {0.0, 180.0})
    for (const auto& [a2, a3] :
         {std::pair(-90.0, 90.0), std::pair(-110.0, 110.0), std::pair(-70.0, 70.0), std::pair(-60.0, 80.0)}) {
      Joints inner;
      inner << turn, a2, a3, 0, parallel ? 90 : 0, 0;
      double miss = 0;
      Joints q;
      for (Eigen::Index i = 0; i < 6; ++i) {
        q[i] = (DegToRad(inner[i]) - arm.offset[i]) * arm.sign[static_cast<size_t>(i)];
        const JointChain::Joint& joint = chain.joints[static_cast<size_t>(i)];
        while (q[i] > kPi) q[i] -= 2 * kPi;
        while (q[i] < -kPi) q[i] += 2 * kPi;
        if (!joint.limited || joint.upper - joint.lower < 2 * kMargin) continue;
        const double held = std::clamp(q[i], joint.lower + kMargin, joint.upper - kMargin);
        miss += std::abs(held - q[i]);
        q[i] = held;
      }
      if (miss >= best_miss - 1e-9) continue;
      best_miss = miss;
      best = q;
    }
  return best;
}

std::string UncheckedLinks(const ChainOfLinks& found) {
  std::set<int> with_body;
  for (const AttachedLink& link : found.links)
    if (!link.link.collisions.empty()) with_body.insert(link.moves_with);
  std::vector<std::string> without;
  for (int link = 0; link < 6; ++link)
    if (!with_body.contains(link)) without.push_back(link == 0 ? "base" : fmt::format("link{}", link));
  if (without.empty()) return "";
  return fmt::format(
      "# GUESS: the URDF gives these links no collision shape, so nothing sees them touch. Add bodies for "
      "them.\n"
      "interference: {{unchecked_links: [{}]}}\n",
      fmt::join(without, ", "));
}

}  // namespace

std::string YamlPath(const fs::path& file, const fs::path& folder) {
  const fs::path relative = file.lexically_relative(folder);
  // Two files that share no more than the root are not moved together.
  const bool apart = std::next(file.begin()) == file.end() || std::next(folder.begin()) == folder.end() ||
                     *std::next(file.begin()) != *std::next(folder.begin());
  return Quoted(apart || relative.empty() ? file.string() : relative.string());
}

std::string SampleCellText(const std::string& name) {
  std::vector<std::string> names;
  for (const SampleCell& cell : SampleCells()) {
    if (!cell.first) continue;
    names.emplace_back(cell.name);
    if (cell.name != name) continue;
    std::string text = kHead;
    std::string_view rest = cell.text;
    while (!rest.empty()) {
      const std::string_view line = rest.substr(0, rest.find('\n') + 1);
      rest.remove_prefix(line.size());
      if (line.starts_with("# yaml-language-server")) continue;  // the schema does not lie beside this file
      for (const Remark& remark : kRemarks)
        if (line.starts_with(remark.key)) text += remark.text;
      text += line;
    }
    return text;
  }
  const std::string near = NearestName(name, names);
  throw InputError(SourceLocation{},
                   fmt::format("--arm: given {}; allowed: a URDF file, or one of {}{}", name,
                               fmt::join(names, ", "), near.empty() ? "" : "; nearest: " + near));
}

std::string UrdfCellText(const UrdfChoice& choice, const fs::path& folder) {
  constexpr size_t kMaxBytes = size_t{16} << 20;
  const std::string name = choice.file.string();
  const UrdfModel model = ReadUrdf(ReadFile(choice.file, kMaxBytes), name,
                                   [](const std::string& included) { return ReadFile(included, kMaxBytes); });
  const Links links(model);
  const std::string base = links.Base(choice.base_link);
  CheckLink(model, base);
  const std::string flange = links.Flange(choice.flange_link, base);
  const ChainOfLinks found = FindChain(model, base, flange);
  const DerivedArm derived =
      DeriveArm(found.chain, choice.tolerance.value_or(UrdfSettings{}.tolerance), name, "--tolerance-mm");
  const double reach = ArmLength(derived.arm);
  const FirstTool tool = ToolFor(reach);
  std::string packages;
  for (const auto& [package, at] : FindPackages(model, choice.file))
    packages += fmt::format("{}{}: {}", packages.empty() ? "" : ", ", Quoted(package), YamlPath(at, folder));
  if (!packages.empty()) packages = fmt::format(", packages: {{{}}}", packages);
  if (choice.tolerance) packages += fmt::format(", tolerance_mm: {}", ShortestNumber(*choice.tolerance));

  std::string text = kHead;
  text += fmt::format(
      "millpose_cell: 1\nname: {0}\narm:\n  name: {0}\n"
      "  # Lengths, signs, limits, speeds and collision shapes are read from here (docs/urdf.md).\n"
      "  urdf: {{file: {1}, base_link: {2}, flange_link: {3}{4}}}\n{5}",
      Quoted(model.name.empty() ? "arm" : model.name), YamlPath(choice.file, folder), Quoted(base),
      Quoted(flange), packages, MissingBounds(found.chain));
  text +=
      "  # GUESS: a URDF has no accelerations. Take the maker's, or what the controller is set to.\n"
      "  accelerations_deg_s2: [200, 200, 200, 300, 300, 500]\n  accelerations_assumed: true\n";
  text += kRemarks[0].text;
  text += reach > 1800
              ? "  joint_stiffness_Nm_per_rad: [8.9e6, 6.78e6, 1.13e7, 2.01e6, 1.65e6, 1.35e6]\n"
                "  joint_stiffness_source: assumed, those of another large arm (Chen et al. 2021, eq. 14)\n"
              : "  joint_stiffness_Nm_per_rad: [6.0e4, 6.0e4, 3.0e4, 1.0e4, 1.0e4, 1.0e4]\n"
                "  joint_stiffness_source: assumed for a small arm, no source\n";
  text += kRemarks[1].text;
  text +=
      "base_in_world: {xyz_mm: [0, 0, 0], abc_deg: [0, 0, 0]}   # A about Z, then B about new Y, then C "
      "about new X\n";
  const Joints home = FindHome(derived.arm, found.chain);
  std::vector<std::string> angles;
  for (const double q : home) angles.push_back(Number(RadToDeg(q), 1e-2));
  text += kRemarks[2].text;
  text += fmt::format("home_deg: [{}]\n", fmt::join(angles, ", "));
  text += ToolText(tool, derived.X_FE);
  text += UncheckedLinks(found);
  text +=
      "auto_excluded_pairs: true                # shapes of neighbours that overlap by construction\n"
      "# GUESS: distances that the arm keeps between cuts and while it cuts.\n"
      "clearance_mm: {free: 10, cutting: 2}\n";
  text +=
      fmt::format("stiffness: {{at: tool_tip, characteristic_length_mm: {}}}\n", reach > 1800 ? 1000 : 600);
  return text +
         "# GUESS: LinuxCNC needs nothing more. KRL and SINUMERIK need the texts of your plant "
         "(docs/krl.md,\n"
         "# docs/sinumerik.md), then their names under `programs` of the job.\n"
         "controllers:\n  linuxcnc:\n"
         "    # GUESS: the controller counts the axes as the URDF does. Compare signs and zeros joint by "
         "joint.\n"
         "    axis_signs: [1, 1, 1, 1, 1, 1]\n    axis_offsets_deg: [0, 0, 0, 0, 0, 0]\n";
}

}  // namespace millpose
