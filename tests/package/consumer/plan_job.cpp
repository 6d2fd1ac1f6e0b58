// SPDX-License-Identifier: GPL-3.0-or-later
// usage: plan_job JOB.yaml FOLDER: what `millpose plan` does, from another program.
#include <cstdio>
#include <millpose/plan.hpp>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  millpose::PlanArguments arguments;
  arguments.job = argv[1];
  arguments.out = argv[2];
  const millpose::PlanOutcome outcome = millpose::RunPlan(arguments, millpose::Silent(), {});
  std::puts(outcome.text.c_str());
  return outcome.exit_status;
}
