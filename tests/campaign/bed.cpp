// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/bed.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "program/krl/krl.hpp"
#include "program/rapid/rapid.hpp"
#include "tests/program/station_plan.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose::campaign {
namespace {

const std::set<std::string> kPlant = {"SPINDLE_ON", "SPINDLE_OFF", "SUCTION", "LIGHT"};

/// Texts that call programs of the plant, also for every pass.
void AddPlant(const std::string& controller, PostSettings& settings) {
  const auto call = [&](const std::string& name, const std::string& argument) {
    if (controller == "rapid") return fmt::format("{} {};", name, argument);
    return controller == "linuxcnc"
               ? fmt::format("O<{}> CALL [{}]", name, argument)
               : fmt::format("{}{}({})", controller == "fanuc" ? "CALL " : "", name, argument);
  };
  settings.texts["spindle_on"] = call("SPINDLE_ON", "{rpm}");
  settings.texts["spindle_off"] = call("SPINDLE_OFF", "0");
  settings.texts["pass_begin"] = call("SUCTION", "{pass}");
  settings.texts["pass_end"] = call("LIGHT", "1");
  for (const std::string& name : kPlant) settings.calls.push_back({name});
}

PostSettings SettingsOf(const std::string& variant) {
  PostSettings settings = SampleSettings(variant);
  const std::string controller = ControllerOf(variant);
  const auto output = [&](bool on) -> std::string {
    if (controller == "krl") return on ? "$OUT[8]=TRUE" : "$OUT[8]=FALSE";
    if (controller == "fanuc") return on ? "DO[8]=ON" : "DO[8]=OFF";
    if (controller == "urscript")
      return fmt::format("set_standard_digital_out(7, {})", on ? "True" : "False");
    if (controller == "rapid") return on ? "Set coolant;" : "Reset coolant;";
    return on ? "M8" : "M9";
  };
  settings.texts["coolant_on"] = output(true);
  settings.texts["coolant_off"] = output(false);
  if (variant.ends_with("_plant")) AddPlant(ControllerOf(variant), settings);
  if (variant.ends_with("_more")) {
    settings.path_acceleration = 2000;
    settings.load = ToolLoad{85, {-120, 0, 130}, {4, 5, 6}};
    settings.controller_axes = {{"E1", "", AxisKind::kLinear, 500}, {"E2", "", AxisKind::kRotary, -20.5}};
  }
  if (variant.ends_with("_split") || variant.ends_with("_load")) settings.max_motions = 10;
  return settings;
}

KrlOptions KrlOptionsOf(const std::string& variant) {
  KrlOptions options;
  if (variant.ends_with("_more")) {
    options.orientation_acceleration = 5;
    options.write_load = true;
  }
  if (variant.ends_with("_numbered")) {
    options.base_number = 3;
    options.tool_number = 2;
  }
  return options;
}

/// What a machine with rail and table has beside the arm.
void AddExternal(const std::string& controller, const PlanResult& plan, Machine& machine) {
  machine.external = controller == "krl"         ? std::vector<std::string>{"E1", "E2"}
                     : controller == "fanuc"     ? std::vector<std::string>{"E1", "GP2_J1"}
                     : controller == "sinumerik" ? std::vector<std::string>{"RAIL_AX", "TAB_AX"}
                     : controller == "rapid"     ? std::vector<std::string>{"eax_a", "eax_b"}
                                                 : std::vector<std::string>{"U", "V"};
  machine.coupled = controller == "krl" || controller == "rapid";
  if (controller == "rapid") {
    const RapidOptions options = RapidStations(plan, true);
    machine.robroot.translation() = options.base_frame.position;
    machine.root.translation() = options.work_unit->frame.position;
    machine.unit = options.work_unit->name;
    return;
  }
  const KrlCellNumbers numbers = KrlNumbers(plan, true);
  machine.robroot.translation() = numbers.ersysroot;
  machine.carriage.translation() = numbers.carriage;
  machine.root.translation() = numbers.root;
  machine.flange.translation() = Eigen::Vector3d(0, 0, 40);
}

/// No program has more than 100 lines: some need more of them for a pass.
PlanResult PlanOf(const std::string& variant) {
  if (variant == "linuxcnc_stations") return StationPlan("both", {.points = 2, .ring = false, .lift = 8});
  if (variant.ends_with("_stations")) return StationPlan("both");
  if (variant.ends_with("_plant"))
    return SamplePlan({.points = 2, .ring = false, .lift = variant == "linuxcnc_plant" ? 8.0 : 50.0});
  const bool long_texts = variant == "linuxcnc" || variant == "krl_split" || variant == "krl_more" ||
                          variant == "rapid_split" || variant == "rapid_load";
  PlanResult plan =
      long_texts ? SamplePlan({.points = 3, .passes = 1, .lift = 20}) : SamplePlan({.points = 4});
  plan.passes[0].points[0].point.kind = PointKind::kLeadIn;
  return plan;
}

/// A plan that differs in its speeds alone: nothing tells its program but the feeds and the spindle.
PlanResult OtherThan(PlanResult plan) {
  plan.spindle_speed *= 1.1;
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& point : pass.points) point.point.feed_rate *= 1.2;
  return plan;
}

MotionOptions OptionsOf() {
  MotionOptions options = SampleFeeds();
  options.outputs = {{5, true, 0, true}, {5, false, 0, false}};
  return options;
}

}  // namespace

Bed::Bed(const std::string& variant)
    : variant_(variant), controller_(ControllerOf(variant)), plan_(PlanOf(variant)) {
  settings_ = SettingsOf(variant);
  program_ = MakeMotionProgram(plan_, OptionsOf());
  const KrlOptions krl = KrlOptionsOf(variant);
  post_ = controller_ == "krl" ? std::make_unique<KrlPost>(krl) : SamplePost(variant);
  const bool stations = variant.ends_with("_stations");
  if (variant == "rapid_load") {
    RapidOptions options;
    options.load_from = "HOME:/parts";
    post_ = std::make_unique<RapidPost>(options);
  }
  if (stations) {
    StationPost post(controller_, plan_, controller_ == "krl" || controller_ == "rapid");
    settings_.X_WB = post.settings.X_WB;
    settings_.mechanism = post.settings.mechanism;
    settings_.controller_axes = post.settings.controller_axes;
    post_ = std::move(post.post);
  }
  world_ = std::make_unique<World>(SampleCell(plan_));
  options_ = SampleOptions(plan_);
  machine_ = {plan_.arm,
              plan_.X_FT,
              settings_.R_TC(),
              WordOf(kAngleOrderWords, settings_.rotation),
              variant == "linuxcnc_cartesian",
              settings_.tool_name};
  machine_.base_number = krl.base_number;
  machine_.tool_number = krl.tool_number;
  if (variant == "fanuc_held") machine_.base_number = 1;
  if (variant.ends_with("_plant")) machine_.plant = kPlant;
  machine_.X_BP = program_.X_BP.value_or(Pose::Identity());
  if (stations) AddExternal(controller_, plan_, machine_);
  program_.frames_checked = variant == "krl_more";
  files_ = post_->Write(Prepared(program_, variant, settings_, plan_.arm), plan_.arm, settings_);
  const MotionProgram other = MakeMotionProgram(OtherThan(plan_), OptionsOf());
  other_ = post_->Write(Prepared(other, variant, settings_, plan_.arm), plan_.arm, settings_);
  trace_ = Run(files_);
  written_ = Read(files_);
}

MotionProgram Bed::Read(const Files& files) const {
  MotionProgram read = post_->Read(files, plan_.arm, settings_);
  if (!read.X_BP) read.X_BP = program_.X_BP;
  if (!read.X_FT) read.X_FT = program_.X_FT;
  return read;
}

Trace Bed::Run(const Files& files) const {
  if (controller_ == "krl") return RunKrl(files, machine_);
  if (controller_ == "sinumerik") return RunSinumerik(files, machine_);
  if (controller_ == "urscript") return RunUrScript(files, machine_);
  if (controller_ == "fanuc") return RunFanuc(files, machine_);
  if (controller_ == "rapid") return RunRapid(files, machine_);
  return RunLinuxCnc(files, machine_);
}

Answer Bed::Ask(const Files& files) const {
  try {
    VerifyOptions options = options_;
    options.written = &written_;
    const std::vector<Finding> findings = Verify(Read(files), *world_, &program_, options, {.threads = 1});
    if (findings.empty()) return {true, ""};
    return {false, fmt::format("{}:{}: {}", findings[0].file, findings[0].line, findings[0].message)};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

const std::vector<std::unique_ptr<Bed>>& Beds() {
  static const std::vector<std::unique_ptr<Bed>> beds = [] {
    std::vector<std::unique_ptr<Bed>> list;
    for (const char* variant :
         {"krl",       "krl_more",          "krl_numbered",    "krl_split",          "krl_stations",
          "sinumerik", "sinumerik_euler",   "sinumerik_split", "sinumerik_stations", "krl_plant",
          "urscript",  "urscript_plant",    "sinumerik_plant", "linuxcnc_plant",     "linuxcnc_stations",
          "fanuc",     "fanuc_held",        "fanuc_split",     "fanuc_stations",     "fanuc_plant",
          "rapid",     "rapid_split",       "rapid_load",      "rapid_plant",        "rapid_stations",
          "linuxcnc",  "linuxcnc_cartesian"})
      list.push_back(std::make_unique<Bed>(variant));
    return list;
  }();
  return beds;
}

}  // namespace millpose::campaign
