// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/diff_folders.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "base/yaml/value.hpp"
#include "job/assemble.hpp"
#include "job/inputs.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "planning/result/plan_result.hpp"
#include "run/pipeline/commands/diff_batches.hpp"
#include "run/pipeline/operations/done_operation.hpp"
#include "store/output_folder.hpp"
#include "store/read_whole.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;
using JsonTree = nlohmann::json;

constexpr double kRounding = 1e-9;   // relative: figures that differ by less are the same
constexpr double kSamePlace = 1e-6;  // mm
constexpr double kSameTurn = 1e-8;   // rad

/// Everything of a folder that is compared. Reading throws JsonTree::exception for a strange summary.
struct Side {
  fs::path folder;
  PlanResult plan;
  JsonTree summary;
  std::string job, cell;
  std::map<std::string, ProgramFiles> programs;  // by controller
};

Side ReadSide(const fs::path& folder, const FileRoot& root) {
  Side side;
  side.folder = folder;
  root.CheckFolder(folder);
  ReadWhole(folder, [&] {
    const Folder open(folder);  // whatever the summary names, nothing outside of it is read
    const auto file = [&](const char* name) { return (folder / name).string(); };
    side.plan = ParsePlanFile(open.Read(kPlanFile), file(kPlanFile));
    side.summary = JsonTree::parse(open.Read("summary.json"), nullptr, false);
    side.job = open.Read("job.yaml");
    side.cell = open.Read("cell.yaml");
    side.programs.clear();
    for (const JsonTree& program : side.summary.at("programs")) {
      if (!program.at("verified").get<bool>()) continue;
      const std::string path = program.at("path").get<std::string>();
      side.programs[program.at("controller").get<std::string>()][fs::path(path).filename().string()] =
          open.Read(path);
    }
  });
  return side;
}

/// Whether two motions go to different places.
bool IsElsewhere(const Motion& x, const Motion& y) {
  if (x.q.has_value() != y.q.has_value() || x.external != y.external) return true;
  if (x.q) return (*x.q - *y.q).cwiseAbs().maxCoeff() > kSameTurn;
  return (x.X_PT.translation() - y.X_PT.translation()).norm() > kSamePlace ||
         RotationVector(x.X_PT.linear().transpose() * y.X_PT.linear()).norm() > kSameTurn;
}

class Diff {
 public:
  Diff(const Side& before, const Side& after, const FileRoot& root) : a_(before), b_(after), root_(root) {}

  Differences Make() {
    Settings("", yaml::ReadYaml(a_.job, "job.yaml"), yaml::ReadYaml(b_.job, "job.yaml"));
    Settings("cell: ", yaml::ReadYaml(a_.cell, "cell.yaml"), yaml::ReadYaml(b_.cell, "cell.yaml"));
    Points();
    Figures();
    for (const char* kind : {"findings", "warnings"}) Sentences(kind);
    Programs();
    return {std::move(changes_), std::move(figures_)};
  }

 private:
  void Add(const std::string& section, const std::string& what, const std::string& before,
           const std::string& after) {
    changes_.push_back({section, what, before, after, {}});
  }

  void AddNumbers(const std::string& section, const std::string& what, double before, double after) {
    figures_.insert(what);
    const double greater = std::max(std::abs(before), std::abs(after));
    if (std::abs(after - before) <= kRounding * greater) return;
    // As many digits as tell the two apart: what is no rounding differs in the tenth at the latest.
    int digits = 6;
    const auto text = [&](double value) { return fmt::format("{:.{}g}", value, digits); };
    while (digits < 10 && text(before) == text(after)) ++digits;
    changes_.push_back({section, what, text(before), text(after), (after - before) / greater});
  }

  void Settings(const std::string& path, const yaml::Value& before, const yaml::Value& after) {
    using Kind = yaml::Value::Kind;
    if (before.kind == Kind::kMap && after.kind == Kind::kMap) {
      const auto below = [&](const std::string& key) {
        return path.empty() || path.ends_with(": ") ? path + key : path + "." + key;
      };
      const yaml::Value none;
      for (const yaml::Value::Key& key : before.keys) {
        if (path.empty() && key.text == "seed") continue;
        const yaml::Value* other = after.Find(key.text);
        Settings(below(key.text), *before.Find(key.text), other ? *other : none);
      }
      for (const yaml::Value::Key& key : after.keys)
        if (!before.Find(key.text)) Settings(below(key.text), none, *after.Find(key.text));
      return;
    }
    const auto text = [](const yaml::Value& value) {
      return value.kind == Kind::kNull ? std::string() : yaml::WriteYamlLine(value);
    };
    if (const std::string one = text(before), other = text(after); one != other)
      Add("settings", path, one, other);
  }

  void Points() {
    size_t count[2] = {0, 0};
    for (const PassResult& pass : a_.plan.passes) count[0] += pass.points.size();
    for (const PassResult& pass : b_.plan.passes) count[1] += pass.points.size();
    AddNumbers("points", "points", static_cast<double>(count[0]), static_cast<double>(count[1]));
    AddNumbers("points", "passes", static_cast<double>(a_.plan.passes.size()),
               static_cast<double>(b_.plan.passes.size()));
    size_t moved = 0, skipped = 0, fed = 0, posed = 0, uneven = 0;
    double farthest = 0, turned = 0, joint = 0;
    for (size_t p = 0; p < std::min(a_.plan.passes.size(), b_.plan.passes.size()); ++p) {
      const PassResult &one = a_.plan.passes[p], &other = b_.plan.passes[p];
      if (one.points.size() != other.points.size()) {
        ++uneven;
        continue;
      }
      for (size_t t = 0; t < one.points.size(); ++t) {
        const PlannedPoint &x = one.points[t], &y = other.points[t];
        const double off = (x.point.position - y.point.position).norm();
        const double turn = (x.point.tool_axis - y.point.tool_axis).norm();
        if (off > kSamePlace || turn > kSameTurn) ++moved;
        farthest = std::max(farthest, off);
        turned = std::max(turned, turn);
        skipped += (x.skip == Infeasibility::kNone) != (y.skip == Infeasibility::kNone);
        fed += x.point.feed_rate != y.point.feed_rate;
        if (x.skip != Infeasibility::kNone || y.skip != Infeasibility::kNone) continue;
        const double by = (x.q - y.q).cwiseAbs().maxCoeff();
        posed += by > kSameTurn;
        joint = std::max(joint, by);
      }
    }
    if (uneven > 0) Add("points", fmt::format("{} passes have another number of points", uneven), "", "");
    if (moved > 0)
      Add("points",
          fmt::format("{} points lie elsewhere, up to {:.4g} mm, their axes lean by up to {:.4g} deg", moved,
                      farthest, RadToDeg(turned)),
          "", "");
    if (skipped > 0)
      Add("points", fmt::format("{} points are skipped in one of them alone", skipped), "", "");
    if (fed > 0) Add("points", fmt::format("{} points have another feed", fed), "", "");
    if (posed > 0)
      Add("poses",
          fmt::format("{} points are milled in another pose, a joint by up to {:.4g} deg", posed,
                      RadToDeg(joint)),
          "", "");
  }

  /// A figure that one of them does not have counts as not there.
  void Figure(const std::string& what, const JsonTree& before, const JsonTree& after) {
    figures_.insert(what);
    if (before.is_number() && after.is_number())
      return AddNumbers("figures", what, before.get<double>(), after.get<double>());
    if (before == after || (before.is_null() && after.is_null())) return;
    const auto text = [](const JsonTree& value) {
      return value.is_null() ? "" : value.is_string() ? value.get<std::string>() : value.dump();
    };
    Add("figures", what, text(before), text(after));
  }

  static JsonTree At(const JsonTree& summary, const std::string& path) {
    const JsonTree* at = &summary;
    for (size_t from = 0; from < path.size();) {
      const size_t dot = std::min(path.find('.', from), path.size());
      const std::string key = path.substr(from, dot - from);
      if (!at->is_object() || !at->contains(key)) return nullptr;
      at = &(*at)[key];
      from = dot + 1;
    }
    return *at;
  }

  /// Of a list of objects: one figure of each by its name.
  void FiguresOf(const std::string& list, const std::string& name, const std::string& figure) {
    std::map<std::string, std::array<JsonTree, 2>> found;
    for (const size_t side : {0, 1})
      for (const JsonTree& entry : At((side == 0 ? a_ : b_).summary, list)) {
        JsonTree own = At(entry, figure);
        found[entry.at(name).get<std::string>()][side] = std::move(own);
      }
    for (const auto& [of, values] : found)
      Figure(fmt::format("{}.{}.{}", list, of, figure), values[0], values[1]);
  }

  void Figures() {
    for (const char* path : {"points.planned",
                             "points.skipped",
                             "pieces",
                             "gaps.total",
                             "gaps.planned",
                             "stiffness.lambda_t1.worst",
                             "stiffness.lambda_t2.worst",
                             "stiffness.lambda_n.best",
                             "stiffness.lambda_n.median",
                             "stiffness.lambda_n.worst",
                             "stiffness.objective.median",
                             "stiffness.objective.worst",
                             "objective",
                             "clearance_min_mm",
                             "continuity.feed_reduced.points",
                             "continuity.feed_reduced.least_mm_min",
                             "deflection.level_mm",
                             "deflection.variation_mm",
                             "deflection.largest_step_between_passes_mm",
                             "deflection.peak_force_N",
                             "reversals.total",
                             "reversals.largest_mark_um",
                             "reversals.marks_sum_um",
                             "budget.sum_um",
                             "registration.face_um_95",
                             "registration.bent_mm",
                             "stock.removed_cm3",
                             "stock.pieces_left_out",
                             "base_window.shift_mm",
                             "base_window.turn_deg"})
      Figure(path, At(a_.summary, path), At(b_.summary, path));
    FiguresOf("budget.rows", "source", "um");
    FiguresOf("cycle_times", "controller", "total_s");
    FiguresOf("path_speed_estimated", "controller", "lowest_feed_share");
  }

  void Sentences(const char* kind) {
    const auto all = [&](const Side& side) { return side.summary.at(kind).get<std::vector<std::string>>(); };
    const std::vector<std::string> one = all(a_), other = all(b_);
    const std::string word = std::string(kind).substr(0, std::string(kind).size() - 1);
    for (const std::string& sentence : one)
      if (std::ranges::find(other, sentence) == other.end())
        Add("findings", fmt::format("{} gone: {}", word, sentence), "", "");
    for (const std::string& sentence : other)
      if (std::ranges::find(one, sentence) == one.end())
        Add("findings", fmt::format("new {}: {}", word, sentence), "", "");
  }

  MotionProgram Read(const Side& side, const JobInputs& inputs, const std::string& controller) const {
    return inputs.cell.controllers.at(controller)
        .post->Read(side.programs.at(controller), side.plan.arm,
                    MakePostSettings(inputs.job, inputs.cell, controller));
  }

  void Programs() {
    std::map<std::string, int> controllers;
    for (const auto& [controller, files] : a_.programs) controllers[controller] |= 1;
    for (const auto& [controller, files] : b_.programs) controllers[controller] |= 2;
    std::optional<JobInputs> one, other;
    for (const auto& [controller, in] : controllers) {
      if (in != 3) {
        Add("programs", controller, in & 1 ? "written" : "", in & 2 ? "written" : "");
        continue;
      }
      if (a_.programs.at(controller) == b_.programs.at(controller)) continue;
      try {
        if (!one) one = LoadJobInputs(a_.folder / "job.yaml", {}, {}, root_);
        if (!other) other = LoadJobInputs(b_.folder / "job.yaml", {}, {}, root_);
      } catch (const InputError&) {  // files of the job are gone: the texts are all there is
        Add("programs",
            controller + ": the texts differ; what they were planned from is not there to read them by", "",
            "");
        continue;
      }
      Motions(controller, Read(a_, *one, controller), Read(b_, *other, controller));
    }
  }

  void Motions(const std::string& controller, const MotionProgram& one, const MotionProgram& other) {
    const auto add = [&](const std::string& what, size_t count) {
      if (count > 0) Add("programs", fmt::format("{}: {} {}", controller, count, what), "", "");
    };
    AddNumbers("programs", controller + ": motions", static_cast<double>(one.motions.size()),
               static_cast<double>(other.motions.size()));
    AddNumbers("programs", controller + ": events", static_cast<double>(one.events.size()),
               static_cast<double>(other.events.size()));
    if (one.motions.size() == other.motions.size()) {
      size_t types = 0, targets = 0, feeds = 0, corners = 0;
      for (size_t i = 0; i < one.motions.size(); ++i) {
        const Motion &x = one.motions[i], &y = other.motions[i];
        types += x.type != y.type;
        targets += IsElsewhere(x, y);
        feeds += x.feed != y.feed || x.duration != y.duration;
        corners += x.exact != y.exact || x.blend != y.blend;
      }
      add("motions of another kind", types);
      add("motions to another target", targets);
      add("motions with another feed", feeds);
      add("motions with another corner", corners);
    }
    if (one.events.size() == other.events.size()) {
      size_t events = 0;
      for (size_t i = 0; i < one.events.size(); ++i) {
        const ProgramEvent &x = one.events[i], &y = other.events[i];
        events +=
            x.kind != y.kind || x.before_motion != y.before_motion || x.value != y.value || x.text != y.text;
      }
      add("events that are others, or elsewhere", events);
    }
    const auto frames = [](const MotionProgram& program) {
      return std::pair(program.X_BP ? program.X_BP->matrix() : Eigen::Matrix4d::Zero().eval(),
                       program.X_FT ? program.X_FT->matrix() : Eigen::Matrix4d::Zero().eval());
    };
    if (frames(one) != frames(other)) Add("programs", controller + ": another base or tool", "", "");
  }

  const Side &a_, &b_;
  const FileRoot& root_;
  std::vector<Change> changes_;
  std::set<std::string> figures_;
};

}  // namespace

namespace {

Differences Compare(const fs::path& before, const fs::path& after, const FileRoot& root) {
  try {
    return Diff(ReadSide(before, root), ReadSide(after, root), root).Make();
  } catch (const JsonTree::exception&) {
    throw InputError(
        {after.string()},
        fmt::format("its summary.json, or that of {}, is none that millpose plan wrote", before.string()));
  }
}

}  // namespace

std::string Change::Text() const {
  std::string text = fmt::format("{:<10} {}", section, operation.empty() ? what : operation + ": " + what);
  if (!before.empty() || !after.empty())
    text += fmt::format(": {} -> {}", before.empty() ? "(none)" : before, after.empty() ? "(none)" : after);
  return text;
}

Differences DiffFolders(const DiffArguments& arguments) {
  if (IsBatchFolder(arguments.before) || IsBatchFolder(arguments.after)) return DiffBatches(arguments);
  for (const fs::path& folder : {arguments.before, arguments.after})
    if (!IsOutputFolder(folder))
      throw InputError({folder.string()}, "is no output folder of millpose (it has no .millpose)");
  const std::vector<std::string> before = OperationFolders(arguments.before),
                                 after = OperationFolders(arguments.after);
  if (before != after)
    throw InputError(
        {arguments.after.string()},
        fmt::format("has {} where {} has {}; allowed: two plans, or two of the same operations",
                    after.empty() ? "one plan" : fmt::format("operations {}", fmt::join(after, ", ")),
                    arguments.before.string(),
                    before.empty() ? "one plan" : fmt::format("operations {}", fmt::join(before, ", "))));
  if (before.empty()) return Compare(arguments.before, arguments.after, arguments.root);
  Differences all;
  for (const std::string& operation : before) {
    Differences own = Compare(arguments.before / operation, arguments.after / operation, arguments.root);
    all.figures.merge(own.figures);
    for (Change& change : own.changes) {
      change.operation = fs::path(operation).filename().string();
      all.changes.push_back(std::move(change));
    }
  }
  return all;
}

}  // namespace millpose
