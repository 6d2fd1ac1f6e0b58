// SPDX-License-Identifier: GPL-3.0-or-later
// What whole plans cost, by parts: CPU time a point on one thread, for jobs of growing size. Prints a table
// and is no verdict; says nothing of plans that are resumed.
//   bench_plan [points…]          of the panel, about so many; default 2000 and 10000
//   bench_plan JOB.yaml [key=value…]
#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "base/cpu_time.hpp"
#include "pipeline/run.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

/// CPU seconds by stage.
class StageClock : public Progress {
 public:
  void Begin(std::string_view stage, size_t total) override {
    stage_ = stage;
    if (stage == "passes") points_ = total;
    start_ = ProcessCpuSeconds();
  }
  void Advance(size_t) override {}
  void End(std::string_view) override { seconds_[stage_] += ProcessCpuSeconds() - start_; }

  size_t points() const { return points_; }
  double Of(std::initializer_list<const char*> stages) const {
    double sum = 0;
    for (const char* stage : stages)
      if (const auto found = seconds_.find(stage); found != seconds_.end()) sum += found->second;
    return sum;
  }

 private:
  std::string stage_;
  std::map<std::string, double> seconds_;
  size_t points_ = 0;
  double start_ = 0;
};

void PrintRow(const char* part, double seconds, size_t points, double goal) {
  fmt::print("  {:<48} {:>9.2f} {:>9.3f} {:>7}\n", part, seconds, 1e3 * seconds / static_cast<double>(points),
             goal > 0 ? fmt::format("{:.2f}", goal) : "");
}

/// Plans a job and prints what it took; goals are those for the panel, ms a point.
void Measure(const std::filesystem::path& job, std::vector<Override> overrides) {
  const std::filesystem::path out =
      std::filesystem::temp_directory_path() / fmt::format("bench_plan_{}", ::getpid());
  PlanArguments arguments;
  arguments.job = job;
  arguments.out = out;
  arguments.threads = 1;
  arguments.overrides = std::move(overrides);
  StageClock clock;
  const auto before = CpuSeconds();
  const double start = ProcessCpuSeconds();
  RunPlan(arguments, clock, {});
  const double all = ProcessCpuSeconds() - start;
  auto parts = CpuSeconds();
  for (size_t i = 0; i < kCpuParts; ++i) parts[i] -= before[i];
  std::filesystem::remove_all(out);

  const double optima = parts[static_cast<size_t>(CpuPart::kOptima)];
  const double interference = parts[static_cast<size_t>(CpuPart::kInterference)];
  const double passes = clock.Of({"passes"}), gaps = clock.Of({"gaps"}), programs = clock.Of({"programs"});
  const size_t points = clock.points();
  fmt::print("{}, {} points\n  {:<48} {:>9} {:>9} {:>7}\n", job.parent_path().filename().string(), points,
             "part", "CPU s", "ms/point", "goal");
  PrintRow("per-point optima", optima, points, 0.25);
  PrintRow("ladder search, refinement, smoothing", passes - optima - interference, points, 0.25);
  PrintRow("interference of nodes and motions", interference, points, 0.45);
  PrintRow("gaps", gaps, points, 0.2);
  PrintRow("planning", passes + gaps, points, 1.15);
  PrintRow("import, gouges, report", all - passes - gaps - programs, points, 0.15);
  PrintRow("programs written, read back, replayed", programs, points, 0.3);
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  PrintRow("all", all, points, 0);
  fmt::print("  peak memory so far {:.0f} MB\n", static_cast<double>(usage.ru_maxrss) / 1024);
}

/// The panel with about `points` points: step-over and spacing shrink alike.
void MeasurePanel(double points) {
  const double finer = std::sqrt(2386 / points);
  Measure(std::filesystem::path(SourceDir()) / "toolpaths/cabin_panel/job.yaml",
          {{"toolpath.stepover_mm", fmt::format("{:.3f}", 20 * finer)},
           {"toolpath.spacing_mm", fmt::format("{:.3f}", 10 * finer)}});
}

}  // namespace
}  // namespace millpose

int main(int argc, char** argv) {
  using namespace millpose;
  if (argc == 1) {
    for (const double points : {2e3, 1e4}) MeasurePanel(points);
  } else if (std::string(argv[1]).ends_with(".yaml")) {
    std::vector<Override> overrides;
    for (int i = 2; i < argc; ++i) overrides.push_back(ParseOverride(argv[i]));
    Measure(argv[1], overrides);
  } else {
    for (int i = 1; i < argc; ++i) MeasurePanel(std::stod(argv[i]));
  }
}
