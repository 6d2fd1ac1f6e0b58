// SPDX-License-Identifier: GPL-3.0-or-later
// 100,000 points written, read back and verified, per controller. Bound: 60 s on two cores, 500 MB
// (`/usr/bin/time -v bench_programs`).
#include <benchmark/benchmark.h>

#include "program/economy.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

void WriteAndVerify(benchmark::State& state, const std::string& variant, const EconomyOptions& economy) {
  const PlanResult plan =
      SamplePlan({.points = 200, .spacing = 1, .ring = false, .passes = 500, .stepover = 0.5});
  const World world(SampleCell(plan));
  const PostSettings settings = SampleSettings(variant);
  const auto post = SamplePost(variant);
  size_t findings = 0, motions = 0, bytes = 0;
  for (auto _ : state) {
    const MotionProgram program = MakeMotionProgram(plan);
    const MotionProgram written = Economise(program, economy).program;
    const ProgramFiles files = post->Write(written, plan.arm, settings);
    const MotionProgram read = post->Read(files, plan.arm, settings);
    findings += Verify(read, world, &program, SampleOptions(plan), {.threads = 2}).size();
    motions = read.motions.size();
    bytes = 0;
    for (const auto& [name, text] : files) bytes += text.size();
  }
  state.counters["motions"] = static_cast<double>(motions);
  state.counters["MB"] = static_cast<double>(bytes) / 1e6;
  state.counters["findings"] = static_cast<double>(findings);
}

void Programs(benchmark::State& state, const std::string& variant) {
  WriteAndVerify(state, variant, {0, 0, 0});
}
void Thinned(benchmark::State& state, const std::string& variant) { WriteAndVerify(state, variant, {}); }

BENCHMARK_CAPTURE(Programs, krl, "krl")->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(Programs, sinumerik, "sinumerik")->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(Programs, linuxcnc, "linuxcnc")->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(Programs, linuxcnc_cartesian, "linuxcnc_cartesian")
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Programs, rapid, "rapid")->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(Programs, fanuc, "fanuc")->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(Programs, urscript, "urscript")->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(Thinned, krl, "krl")->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace millpose
