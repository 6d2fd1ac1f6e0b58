// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/bed.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "tests/verify/sample_cell.hpp"

namespace millpose::campaign {
namespace {

PostSettings SettingsOf(const std::string& variant) {
  PostSettings settings = SampleSettings(variant);
  settings.texts["coolant_on"] = variant.starts_with("krl") ? "$OUT[8]=TRUE" : "M8";
  settings.texts["coolant_off"] = variant.starts_with("krl") ? "$OUT[8]=FALSE" : "M9";
  if (variant.ends_with("_more")) {
    settings.path_acceleration = 2000;
    settings.orientation_acceleration = 5;
    settings.external = {500, -20.5};
  }
  if (variant.ends_with("_split")) settings.max_motions = 10;
  return settings;
}

/// Speeds of their own for every part of a pass, outputs, a lead-in.
MotionOptions OptionsOf() {
  MotionOptions options;
  options.approach_feed = 1000.0 / 60;
  options.approach_slow = 10;
  options.plunge_feed = 40.0 / 60;
  options.retract_feed = 2000.0 / 60;
  options.outputs = {{5, true, 0, true}, {5, false, 0, false}};
  return options;
}

}  // namespace

Bed::Bed(const std::string& variant)
    : variant_(variant), controller_(ControllerOf(variant)), plan_(SamplePlan({.points = 4, .passes = 2})) {
  plan_.passes[0].points[0].point.kind = PointKind::kLeadIn;
  settings_ = SettingsOf(variant);
  program_ = MakeMotionProgram(plan_, OptionsOf());
  post_ = MakePost(controller_);
  world_ = std::make_unique<World>(SampleCell(plan_));
  options_ = SampleOptions(plan_);
  machine_ = {plan_.arm,          plan_.X_FT,          settings_.R_TC,
              settings_.rotation, settings_.cartesian, settings_.tool_name};
  files_ = post_->Write(program_, plan_.arm, settings_);
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

}  // namespace millpose::campaign
