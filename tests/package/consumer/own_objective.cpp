// SPDX-License-Identifier: GPL-3.0-or-later
// usage: own_objective JOB.yaml [KEY=VALUE …]: plans the job with an objective of its own, the mean
// displacement of the tip under 1 N in any direction, and prints every planned point's value and joints
// (rad).
#include <cstdio>
#include <millpose/objective.hpp>
#include <millpose/plan_job.hpp>

using namespace millpose;

class MeanDeflection final : public PlainObjective {
 public:
  MeanDeflection() : PlainObjective("mean_deflection", "mm/N") {}
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext&, Lanes& out) const override {
    for (int i = 0; i < kLanes; ++i) out.v[i] = (c.xx.v[i] + c.yy.v[i] + c.zz.v[i]) / 3;
  }
};

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  Objectives().Add({"mean_deflection", {}, [](const auto&) { return std::make_unique<MeanDeflection>(); }});
  std::vector<Override> settings{{"pose.objective", "{name: mean_deflection}"}};
  for (int i = 2; i < argc; ++i) settings.push_back(ParseOverride(argv[i]));
  const JobInputs job = LoadJobInputs(argv[1], settings);
  const PlannedJob planned = PlanJob(job, NoCheckpoints(), {});
  for (const PassResult& pass : planned.plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (point.skip != Infeasibility::kNone) continue;
      std::printf("%.9g", point.objective);
      for (int i = 0; i < 6; ++i) std::printf(" %.9g", point.q[i]);
      std::printf("\n");
    }
}
