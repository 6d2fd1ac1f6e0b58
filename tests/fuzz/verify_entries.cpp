// SPDX-License-Identifier: GPL-3.0-or-later
// A program beside its plan, as `millpose verify` takes it: read by the reader of every controller, replayed
// with the plan and without.
#include "program/verify/causes.hpp"
#include "tests/fuzz/entries.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

// What `verify` has of one controller's folder.
struct Folder {
  std::unique_ptr<Post> post;
  PostSettings settings;
  MotionProgram planned;
  ProgramFiles files;
};

struct Bed {
  PlanResult plan = SamplePlan();
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);
  std::vector<Folder> folders;

  Bed() {
    options.most_findings = 20;
    for (const char* controller : {"krl", "sinumerik", "linuxcnc"}) {
      Folder folder{MakePost(controller), SampleSettings(controller), MakeMotionProgram(plan), {}};
      folder.planned.frames_checked = std::string(controller) == "krl";
      folder.files = folder.post->Write(Prepared(folder.planned, controller, folder.settings, plan.arm),
                                        plan.arm, folder.settings);
      folders.push_back(std::move(folder));
    }
  }
};

int programs_replayed = 0;

void Listed(const std::vector<Finding>& findings, int lines) {
  for (const Finding& finding : findings)
    Demand(!finding.message.empty() && finding.line >= 0 && finding.line <= lines && finding.count > 0);
  size_t count = 0;
  for (const CauseGroup& group : GroupByCause(findings)) {
    count += group.count;
    Demand(!Describe(group).empty());
  }
  Demand(count >= findings.size());
}

void VerifyText(std::string_view bytes) {
  static const Bed bed;
  const auto lines = static_cast<int>(std::ranges::count(bytes, '\n')) + 1;
  for (const Folder& folder : bed.folders) {
    LetRefuse([&] {
      ProgramFiles files = folder.files;
      files.rbegin()->second = bytes;  // the main file: .src comes after .dat
      MotionProgram program = folder.post->Read(files, bed.plan.arm, folder.settings);
      if (program.motions.size() > 200) return;
      if (!program.X_BP) program.X_BP = folder.planned.X_BP;  // what the controller holds
      if (!program.X_FT) program.X_FT = folder.planned.X_FT;
      for (const MotionProgram* plan : {&folder.planned, static_cast<const MotionProgram*>(nullptr)})
        Listed(Verify(program, bed.world, plan, bed.options, {.threads = 1}), lines);
      ++programs_replayed;
    });
  }
}

}  // namespace

int ProgramsReplayed() { return programs_replayed; }

std::vector<FuzzEntry> VerifyEntries() { return {{"verify", VerifyText, 10}}; }

}  // namespace millpose
