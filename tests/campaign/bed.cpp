// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/bed.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "program/krl/krl.hpp"
#include "tests/verify/sample_cell.hpp"

namespace millpose::campaign {
namespace {

PostSettings SettingsOf(const std::string& variant) {
  PostSettings settings = SampleSettings(variant);
  settings.texts["coolant_on"] = variant.starts_with("krl") ? "$OUT[8]=TRUE" : "M8";
  settings.texts["coolant_off"] = variant.starts_with("krl") ? "$OUT[8]=FALSE" : "M9";
  if (variant.ends_with("_more")) {
    settings.path_acceleration = 2000;
    settings.load = ToolLoad{85, {-120, 0, 130}, {4, 5, 6}};
  }
  if (variant.ends_with("_split")) settings.max_motions = 10;
  return settings;
}

KrlOptions KrlOptionsOf(const std::string& variant) {
  KrlOptions options;
  if (variant.ends_with("_more")) {
    options.orientation_acceleration = 5;
    options.external_axes = {500, -20.5};
    options.write_load = true;
  }
  if (variant.ends_with("_numbered")) {
    options.base_number = 3;
    options.tool_number = 2;
  }
  return options;
}

/// No program has more than 100 lines: some need more of them for a pass.
PlanResult PlanOf(const std::string& variant) {
  const bool long_texts = variant == "linuxcnc" || variant == "krl_split" || variant == "krl_more";
  PlanResult plan =
      long_texts ? SamplePlan({.points = 3, .passes = 1, .lift = 20}) : SamplePlan({.points = 4});
  plan.passes[0].points[0].point.kind = PointKind::kLeadIn;
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
  machine_.X_BP = program_.X_BP.value_or(Pose::Identity());
  program_.frames_checked = variant == "krl_more";
  files_ = post_->Write(Prepared(program_, variant, settings_, plan_.arm), plan_.arm, settings_);
  trace_ = Run(files_);
}

Trace Bed::Run(const Files& files) const {
  if (controller_ == "krl") return RunKrl(files, machine_);
  if (controller_ == "sinumerik") return RunSinumerik(files, machine_);
  return RunLinuxCnc(files, machine_);
}

Answer Bed::Ask(const Files& files) const {
  try {
    MotionProgram read = post_->Read(files, plan_.arm, settings_);
    if (!read.X_BP) read.X_BP = program_.X_BP;
    if (!read.X_FT) read.X_FT = program_.X_FT;
    const std::vector<Finding> findings = Verify(read, *world_, &program_, options_, 1, {});
    if (findings.empty()) return {true, ""};
    return {false, fmt::format("{}:{}: {}", findings[0].file, findings[0].line, findings[0].message)};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

const std::vector<std::unique_ptr<Bed>>& Beds() {
  static const std::vector<std::unique_ptr<Bed>> beds = [] {
    std::vector<std::unique_ptr<Bed>> list;
    for (const char* variant : {"krl", "krl_more", "krl_numbered", "krl_split", "sinumerik",
                                "sinumerik_euler", "sinumerik_split", "linuxcnc", "linuxcnc_cartesian"})
      list.push_back(std::make_unique<Bed>(variant));
    return list;
  }();
  return beds;
}

}  // namespace millpose::campaign
