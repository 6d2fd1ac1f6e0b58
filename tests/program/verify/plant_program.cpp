// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/verify/plant_program.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "program/scanner.hpp"
#include "program/stated_speeds.hpp"
#include "program/verify/standing_alone.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {

PlantProgram::PlantProgram(const std::string& name, bool spindle)
    : controller(name),
      plan_(SamplePlan({.points = 4})),
      settings_(SampleSettings(name)),
      post_(SamplePost(name)) {
  const std::string speed = controller == "krl"         ? "SPINDLE_ON ({rpm})"
                            : controller == "sinumerik" ? "SPINDLE_ON({rpm})"
                                                        : "O<SPINDLE_ON> CALL [{rpm}]";
  const std::string pass = controller == "krl"         ? "SUCTION ({pass})"
                           : controller == "sinumerik" ? "SUCTION({pass})"
                                                       : "O<SUCTION> CALL [{pass}]";
  settings_.texts = {{"spindle_on", spindle ? speed : ""},
                     {"spindle_off", spindle ? Call("SPINDLE_OFF", 0) : ""},
                     {"tool_change", Call("TOOL_CHANGE", 2)},
                     {"pass_begin", pass}};
  for (const char* call : {"SPINDLE_ON", "SPINDLE_OFF", "TOOL_CHANGE", "SUCTION", "LIGHT"})
    settings_.calls.push_back({call});
  MotionOptions options = SampleFeeds();
  options.outputs = {{5, true, 0, true}, {5, false, 0, false}};
  planned_ = MakeMotionProgram(plan_, options);
  planned_.frames_checked = post_->HasOwnWorld();
  MotionProgram written = Prepared(planned_, name, settings_, plan_.arm);
  post_->Round(written, plan_.arm, settings_);
  StateSpeeds(written);
  files_ = post_->Write(written, plan_.arm, settings_);
  for (const std::string_view line : SplitLines(files_.rbegin()->second)) lines.emplace_back(line);
  world_ = std::make_unique<World>(SampleCell(plan_));
}

std::string PlantProgram::Call(const std::string& name, int argument) const {
  if (controller == "krl") return fmt::format("{} ({})", name, argument);
  return controller == "sinumerik" ? fmt::format("{}({})", name, argument)
                                   : fmt::format("O<{}> CALL [{}]", name, argument);
}

std::string PlantProgram::Stop() const { return controller == "krl" ? "HALT" : "M0"; }

std::string PlantProgram::Dwell() const {
  return controller == "krl" ? "WAIT SEC 0.5" : controller == "sinumerik" ? "G4 F0.5" : "G4 P0.5";
}

std::string PlantProgram::Mark(bool begin, int pass) const {
  if (controller == "krl")
    return begin ? fmt::format(";FOLD PASS {} PIECE 0", pass)
                 : fmt::format(";ENDFOLD (PASS {} PIECE 0)", pass);
  const std::string place = fmt::format("{}PASS {} PIECE 0", begin ? "" : "END OF ", pass);
  return controller == "sinumerik" ? "MSG(\"" + place + "\")" : "; " + place;
}

size_t PlantProgram::Find(const std::string& part, int nth) const {
  for (size_t i = 0; i < lines.size(); ++i)
    if (lines[i].find(part) != std::string::npos && nth-- == 0) return i;
  ADD_FAILURE() << controller << ": no line holds " << part;
  return 0;
}

MotionProgram PlantProgram::Read(const std::vector<std::string>& of) const {
  ProgramFiles changed = files_;
  changed.rbegin()->second = fmt::format("{}\n", fmt::join(of, "\n"));
  return post_->Read(changed, plan_.arm, settings_);
}

namespace {

std::string TextOfAll(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) text += fmt::format("{}: {}\n", finding.line, finding.message);
  return text;
}

}  // namespace

std::string PlantProgram::AgainstThePlan() const {
  try {
    std::vector<std::string> original;
    for (const std::string_view line : SplitLines(files_.rbegin()->second)) original.emplace_back(line);
    const MotionProgram written = Read(original);
    VerifyOptions options = SampleOptions(plan_);
    options.written = &written;
    return TextOfAll(Verify(Read(lines), *world_, &planned_, options, {.threads = 1}));
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string PlantProgram::Scope() const { return ScopeOf(Read(lines)); }

std::string PlantProgram::Alone() const {
  try {
    const MotionProgram program = Read(lines);
    const VerifyOptions options = SampleOptions(plan_);
    return TextOfAll(CheckStandingAlone(program, world_->cell(), post_->HasOwnWorld(), options)) +
           TextOfAll(Verify(program, *world_, nullptr, options, {.threads = 1}));
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace millpose
