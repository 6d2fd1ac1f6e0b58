// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/entries.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

void Program(const char* controller, const char* file, std::string_view bytes) {
  LetRefuse([&] {
    MakePost(controller)->Read({{file, std::string(bytes)}}, SampleArm(), SampleSettings(controller));
  });
}

}  // namespace

std::vector<FuzzEntry> ProgramEntries() {
  return {
      {"krl", [](std::string_view bytes) { Program("krl", "a.src", bytes); }},
      {"sinumerik", [](std::string_view bytes) { Program("sinumerik", "a.mpf", bytes); }},
      {"linuxcnc", [](std::string_view bytes) { Program("linuxcnc", "a.ngc", bytes); }},
      {"rapid", [](std::string_view bytes) { Program("rapid", "Sample_wall_plan.mod", bytes); }},
      {"fanuc", [](std::string_view bytes) { Program("fanuc", "Sample_wall_plan.ls", bytes); }},
      {"urscript", [](std::string_view bytes) { Program("urscript", "Sample_wall_plan.script", bytes); }}};
}

}  // namespace millpose
