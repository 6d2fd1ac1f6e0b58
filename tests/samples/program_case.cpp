// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/samples/program_case.hpp"

#include "job/assemble.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "run/pipeline/programs/make_programs.hpp"
#include "tests/program/own_options.hpp"

namespace millpose {

std::vector<std::string> Variants() { return {"krl", "sinumerik", "linuxcnc", "linuxcnc_cartesian"}; }

MotionProgram ProgramCase::Read(const Arm& arm, const std::string& text) const {
  ProgramFiles edited = files;
  edited[name] = text;
  MotionProgram program = post->Read(edited, arm, settings);
  CompleteFrames(program, motions.planned);
  return program;
}

ProgramCase MakeCase(const Sample& sample, const std::string& variant) {
  ProgramCase made;
  made.controller = variant.substr(0, variant.find('_'));
  JobInputs inputs = sample.inputs;
  ControllerOptions& controller = inputs.cell.controllers.at(made.controller);
  if (variant == "linuxcnc_cartesian") SetOwnOptions<LinuxCncPost>(controller, {true, std::nullopt});
  if (made.controller == "krl") {
    controller.shared.texts = {{"spindle_on", "$ANOUT[1]={rpm}\n$OUT[1]=TRUE"},
                               {"spindle_off", "$OUT[1]=FALSE"}};
  }
  controller.shared.outputs = {{5, true, 0, true}, {5, false, 0, false}};
  made.post = controller.post;
  made.settings = MakePostSettings(inputs.job, inputs.cell, made.controller);
  made.options = MakeVerifyOptions(inputs.job, sample.plan.arm);
  made.motions = MakeProgramMotions(sample.plan, inputs, made.controller, {});
  // Golden files do not change with the version.
  for (MotionProgram* program : {&made.motions.planned, &made.motions.written}) {
    for (auto& [key, value] : program->header)
      if (key == "version") value = "millpose 0.0.0";
  }
  made.files = made.post->Write(made.motions.written, sample.plan.arm, made.settings);
  for (const auto& [name, text] : made.files) {
    if (made.name.empty() || text.size() > made.files.at(made.name).size()) made.name = name;
  }
  return made;
}

std::string Text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings)
    text += fmt::format("{}:{}: {}\n", finding.file, finding.line, finding.message);
  return text;
}

}  // namespace millpose
