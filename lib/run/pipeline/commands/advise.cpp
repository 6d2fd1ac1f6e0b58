// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/advise.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "base/yaml/value.hpp"
#include "job/assemble.hpp"
#include "job/engagement_options.hpp"
#include "job/step_meshes.hpp"
#include "planning/standing/leave_in_stock.hpp"
#include "report/deflection.hpp"
#include "run/pipeline/operations/run_job.hpp"
#include "run/pipeline/operations/stock_handed_on.hpp"
#include "run/pipeline/stages/plan_job.hpp"
#include "toolpath/engagement/cutting_power.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr double kMore = 1.05;   // a value is told when so much of it is too much
constexpr double kSafer = 0.98;  // of where a load that goes with the value would reach its limit
constexpr double kRefusedShare = 2;
constexpr double kMostAtOnce = 4;  // times: a value is not changed by more at a time

double ShareOf(const CutLoad& load, const AdviseLimits& limits) {
  return std::max(load.error / limits.error, limits.power ? load.power / *limits.power : 0);
}

const yaml::Value* At(const yaml::Value& root, const std::string& path) {
  const yaml::Value* at = &root;
  for (size_t begin = 0; at && begin <= path.size();) {
    const size_t end = std::min(path.find('.', begin), path.size());
    at = at->kind == yaml::Value::Kind::kMap ? at->Find(path.substr(begin, end - begin)) : nullptr;
    begin = end + 1;
  }
  return at;
}

std::optional<double> NumberAt(const yaml::Value& root, const std::string& path) {
  const yaml::Value* at = At(root, path);
  return at && at->kind == yaml::Value::Kind::kScalar ? ParseNumber(at->text) : std::nullopt;
}

/// One operation of a job, planned with this value or that.
class OperationTrial {
 public:
  OperationTrial(std::filesystem::path job, std::vector<Override> overrides, std::optional<size_t> number,
                 StockHandedOn before, Execution execution, const FileRoot& root)
      : job_(std::move(job)),
        overrides_(std::move(overrides)),
        number_(number),
        before_(std::move(before)),
        execution_(std::move(execution)),
        root_(root) {
    overrides_.push_back(ParseOverride("programs=[]"));
    inputs_ = Load({});
    resolved_ = yaml::ReadYaml(WriteJob(inputs_.job), job_.string());
    given_ = yaml::ReadYaml(inputs_.job_text, job_.string());
  }

  const JobInputs& inputs() const { return inputs_; }
  const CutsOfTool& cuts() const { return cuts_; }

  /// As the job stands. Throws InputError for what cannot be planned.
  CutLoad AsGiven() {
    const PlannedJob planned = Plan(inputs_);
    skipped_ = Skipped(planned.plan);
    cuts_ = CutsOf(planned.plan, MakeCutterShape(inputs_.cell.tool));
    return LoadOf(inputs_, planned);
  }

  /// None where it is refused, or where more points are left out than as the job stands.
  std::optional<CutLoad> With(const std::vector<std::string>& keys, double value) const {
    try {
      std::vector<Override> changes;
      for (const std::string& key : keys)
        changes.push_back(ParseOverride(fmt::format("{}={:.9g}", key, value)));
      const JobInputs inputs = Load(changes);
      const PlannedJob planned = Plan(inputs);
      if (Skipped(planned.plan) > skipped_) return std::nullopt;
      return LoadOf(inputs, planned);
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  std::optional<double> Resolved(const std::string& key) const { return NumberAt(resolved_, key); }

  /// Where the job states a key: the operation, or the job for all.
  std::string Placed(const std::string& key) const {
    if (!number_) return key;
    const yaml::Value& own = given_.Find("operations")->items[*number_];
    const std::string section = key.substr(0, key.rfind('.'));
    return At(own, section) ? fmt::format("operations.{}.{}", inputs_.job.operation, key) : key;
  }

 private:
  JobInputs Load(const std::vector<Override>& changes) const {
    std::vector<Override> all = overrides_;
    all.insert(all.end(), changes.begin(), changes.end());
    JobInputs inputs = LoadJobInputs(job_, all, {}, root_, number_);
    inputs.cut_before = before_.Before(inputs);
    CutStepFiles(
        &inputs, [](int) {}, execution_.stop);
    return inputs;
  }

  PlannedJob Plan(const JobInputs& inputs) const {
    return PlanJob(inputs, NoCheckpoints{}, {execution_.threads, Silent(), execution_.stop});
  }

  static size_t Skipped(const PlanResult& plan) {
    size_t skipped = 0;
    for (const PassResult& pass : plan.passes)
      for (const PlannedPoint& point : pass.points) skipped += point.skip != Infeasibility::kNone;
    return skipped;
  }

  static CutLoad LoadOf(const JobInputs& inputs, const PlannedJob& planned) {
    CutLoad load;
    const DeflectionReport report =
        PredictDeflections(planned.plan, CuttingForce{}, MakeCompliances(inputs.cell));
    for (const DeflectedPoint& point : report.points)
      load.error = std::max(load.error, point.deflection.length);
    const EngagementOptions cutting = MakeEngagementOptions(inputs, planned.prepared.surface.mesh);
    for (const PassResult& pass : planned.plan.passes)
      for (const PlannedPoint& point : pass.points)
        if (point.skip == Infeasibility::kNone && point.point.kind == PointKind::kCut)
          load.power =
              std::max(load.power, CuttingPower(cutting, point.point.engagement, point.point.feed_rate));
    return load;
  }

  std::filesystem::path job_;
  std::vector<Override> overrides_;
  std::optional<size_t> number_;
  StockHandedOn before_;
  Execution execution_;
  const FileRoot& root_;
  JobInputs inputs_;
  yaml::Value resolved_, given_;  ///< with all defaults; as the file has it
  size_t skipped_ = 0;
  CutsOfTool cuts_;
};

/// A setting that may be advised.
struct AdvisedSetting {
  std::string what, unit;
  std::vector<std::string> keys;
  AdviceRange range;
};

std::optional<AdvisedSetting> DepthOf(const OperationTrial& trial) {
  constexpr double kLeastDepth = 0.05;  // of the given one
  const JobSettings& job = trial.inputs().job;
  const double most = trial.inputs().cell.tool.cutting_length;
  const std::string cutting = "process.cutting.depth_mm";
  const std::string layer = fmt::format("toolpath.{}.per_layer_mm", job.toolpath.strategy->Name());
  AdvisedSetting depth{"depth", "mm", {}, {0, 0, most, 0.001}};
  if (const auto own = trial.Resolved(layer)) {
    depth.range.given = *own;
    depth.keys = {trial.Placed(layer)};
    if (trial.Resolved(cutting)) depth.keys.push_back(trial.Placed(cutting));
  } else if (job.toolpath.layers.total > 0) {
    depth.range.given = job.toolpath.layers.per_layer;
    depth.range.largest = std::min(most, job.toolpath.layers.total);
    depth.keys = {trial.Placed("toolpath.depth.per_layer_mm")};
  } else if (const auto stated = trial.Resolved(cutting); stated && job.stock != Standing::kMesh) {
    depth.range.given = *stated;
    depth.keys = {trial.Placed(cutting)};
  } else {
    return std::nullopt;
  }
  depth.range.smallest = kLeastDepth * depth.range.given;
  return depth;
}

std::optional<AdvisedSetting> StepOf(const OperationTrial& trial) {
  constexpr double kLeastEngagement = 20, kMostEngagement = 150;  // deg
  constexpr double kLeastStep = 0.2;                              // of the given one: points go against it
  const JobSettings& job = trial.inputs().job;
  const std::string engagement = fmt::format("toolpath.{}.max_engagement_deg", job.toolpath.strategy->Name());
  if (const auto own = trial.Resolved(engagement))
    return AdvisedSetting{
        "engagement", "deg", {trial.Placed(engagement)}, {*own, kLeastEngagement, kMostEngagement, 0.01}};
  if (job.toolpath.stepover <= 0 || job.toolpath.scallop > 0 || job.toolpath.strategy->DrillPoint())
    return std::nullopt;
  return AdvisedSetting{"step-over",
                        "mm",
                        {trial.Placed("toolpath.stepover_mm")},
                        {job.toolpath.stepover, kLeastStep * job.toolpath.stepover,
                         trial.inputs().cell.tool.cutter_diameter, 0.001}};
}

/// Of a drill the hole says depth and width: the feed is what loads it.
std::optional<AdvisedSetting> FeedOf(const OperationTrial& trial) {
  constexpr double kLeastFeed = 0.05;  // of the given one
  constexpr double kLargestChip = 1;   // mm a tooth: no drill takes more
  const JobSettings& job = trial.inputs().job;
  if (!job.toolpath.strategy->DrillPoint()) return std::nullopt;
  AdvisedSetting feed{"feed", "mm/min", {trial.Placed("process.feed_mm_min")}, {}};
  if (job.plunge_feed) feed.keys.push_back(trial.Placed("process.plunge_feed_mm_min"));
  const double given = 60 * job.feed;
  feed.range = {given, kLeastFeed * given, 60 * kLargestChip * job.spindle_speed * job.cutting->teeth, 0.1};
  return feed;
}

/// The search behind LargestWithin(): a load that goes with the value needs three looks.
class AdviceSearch {
 public:
  AdviceSearch(const AdviseLimits& limits, const AdviceRange& range)
      : limits_(limits),
        range_(range),
        smallest_(Rounded(range.smallest)),
        largest_(Rounded(range.largest)) {}

  Advice Run(const std::function<std::optional<CutLoad>(double)>& load) {
    for (double value = std::clamp(Rounded(range_.given), smallest_, largest_); value > 0;
         value = Next(value)) {
      const std::optional<CutLoad> found = load(value);
      share_ = found ? ShareOf(*found, limits_) : kRefusedShare;
      if (share_ <= 1)
        within_ = value, load_ = *found;
      else
        beyond_ = value, over_ = found;
    }
    return Told();
  }

 private:
  double Rounded(double value) const {
    return std::max(1.0, std::floor(value / range_.grain + 1e-6)) * range_.grain;
  }
  double More() const { return std::max(Rounded(kMore * within_), within_ + range_.grain); }

  /// The value to look at after this one; 0: the search has ended. A load that goes with the value is met
  /// within a few percent at once, so that 5 % more end the search; others are narrowed in by halves.
  double Next(double last) {
    const double limit = kSafer * last / std::max(share_, 1e-6);  // where such a load reaches its limit
    if (within_ <= 0) {
      const double less = Rounded(std::clamp(limit, last / kMostAtOnce, 0.9 * last));
      return beyond_ <= smallest_ ? 0 : std::max(less, smallest_);
    }
    const double more = More();
    if (beyond_ <= 0) {
      if (within_ >= largest_) return 0;
      const double guess = Rounded(std::min(std::max(limit, climb_ * within_), kMostAtOnce * within_));
      if (limit <= more) climb_ = std::min(kMostAtOnce, std::max(1.1, climb_ * climb_));
      return std::min(largest_, std::max(more, guess));
    }
    if (beyond_ <= more + range_.grain / 2) return 0;
    const double guess = Rounded(limit);
    const bool halve = last == beyond_ ? guess <= within_ : guess <= more && crept_;
    crept_ = guess <= more;
    return std::clamp(halve ? Rounded(std::sqrt(within_ * beyond_)) : guess, more, beyond_ - range_.grain);
  }

  Advice Told() const {
    Advice advice;
    advice.given = range_.given;
    advice.value = within_, advice.load = load_;
    advice.beyond = beyond_, advice.over = over_;
    if (within_ <= 0) {
      advice.bound = AdviceBound::kSmallest;
      if (over_) advice.load = *over_;
    } else if (beyond_ <= 0) {
      advice.bound = AdviceBound::kLargest;
    } else if (!over_) {
      advice.bound = AdviceBound::kRefused;
    } else if (limits_.power && over_->power / *limits_.power > over_->error / limits_.error) {
      advice.bound = AdviceBound::kPower;
    }
    return advice;
  }

  const AdviseLimits& limits_;
  const AdviceRange& range_;
  double smallest_, largest_;
  double within_ = 0, beyond_ = 0;  // 0: not known
  CutLoad load_;
  std::optional<CutLoad> over_;
  double share_ = 0;    // of its limit, the last look's
  double climb_ = 1;    // by which a value that is within is raised at least
  bool crept_ = false;  // the last value was raised by 5 % alone
};

OperationAdvice AdviseOperation(OperationTrial& trial, const AdviseLimits& limits, Progress& progress) {
  OperationAdvice advice{limits, {}, {}, {}};
  if (!trial.inputs().job.cutting) {
    advice.without =
        "process.cutting is missing: what the cutter takes off, and with which force, is not known";
    return advice;
  }
  advice.given = trial.AsGiven();
  if (advice.given.error <= 0) {
    advice.without = "nothing is cut: no error follows";
    return advice;
  }
  for (const auto& setting : {DepthOf(trial), StepOf(trial), FeedOf(trial)}) {
    if (!setting) continue;
    AdviceRange range = setting->range;
    range.largest = std::max(range.largest, range.given);
    progress.Begin("advice", 0);
    Advice& found = advice.advices.emplace_back(
        LargestWithin(limits, range, [&](double value) { return trial.With(setting->keys, value); }));
    found.what = setting->what, found.unit = setting->unit, found.keys = setting->keys;
    progress.End(fmt::format("{} {:.6g} {}", found.what, found.value, found.unit));
  }
  return advice;
}

}  // namespace

Advice LargestWithin(const AdviseLimits& limits, const AdviceRange& range,
                     const std::function<std::optional<CutLoad>(double)>& load) {
  return AdviceSearch(limits, range).Run(load);
}

std::vector<OperationAdvice> Advise(const std::filesystem::path& job, const std::vector<Override>& overrides,
                                    const AdviseLimits& limits, int threads, const FileRoot& root,
                                    Progress& progress, const std::stop_token& stop) {
  const size_t count = OutlineOf(root.Read(job), job.string(), overrides).operations.size();
  std::vector<OperationAdvice> advices;
  StockHandedOn handed;
  for (size_t i = 0; i < std::max<size_t>(count, 1); ++i) {
    OperationTrial trial(job, overrides, count > 0 ? std::optional(i) : std::nullopt, handed,
                         {threads, progress, stop}, root);
    advices.push_back(AdviseOperation(trial, limits, progress));
    if (!trial.inputs().job.workpiece.HasStock() || i + 1 >= count) continue;
    if (!trial.inputs().job.cutting) trial.AsGiven();
    handed.Add(trial.cuts());
  }
  return advices;
}

}  // namespace millpose
