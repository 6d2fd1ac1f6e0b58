// SPDX-License-Identifier: GPL-3.0-or-later
// What whole plans cost, by parts: CPU time a point on one thread beside its goal, for jobs of growing size,
// with the growth from the first to the last; then wall time on two threads; then what a change of a plan
// that stands costs. Prints tables and is no verdict.
//   bench_plan [points…]          of the panel, about so many; default 2000, 10000 and 100000
//   bench_plan edits              changes alone, of 5,800 points
//   bench_plan JOB.yaml [key=value…]
#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/cpu_time.hpp"
#include "run/pipeline/outputs/run.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

constexpr double kPointsOfEdits = 5800;

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
  double Of(const std::vector<const char*>& stages) const {
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

/// A folder that goes with its owner.
class Scratch {
 public:
  Scratch() : path_(fs::temp_directory_path() / fmt::format("bench_plan_{}", ::getpid())) {}
  ~Scratch() { fs::remove_all(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Cost {
  size_t points = 0;
  double cpu = 0, wall = 0;  ///< s
};

double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Cost RunOnce(const PlanArguments& arguments, StageClock& clock) {
  const double cpu = ProcessCpuSeconds(), wall = WallSeconds();
  RunPlan(arguments, clock, {});
  return {clock.points(), ProcessCpuSeconds() - cpu, WallSeconds() - wall};
}

PlanArguments Arguments(const fs::path& job, const fs::path& out, std::vector<Override> overrides,
                        int threads) {
  PlanArguments arguments;
  arguments.job = job;
  arguments.out = out;
  arguments.threads = threads;
  arguments.overrides = std::move(overrides);
  return arguments;
}

/// `goal` in ms a point, 0 for none.
void PrintRow(const std::string& part, double seconds, size_t points, double goal) {
  fmt::print("  {:<48} {:>9.2f} {:>9.3f} {:>7}\n", part, seconds, 1e3 * seconds / static_cast<double>(points),
             goal > 0 ? fmt::format("{:.2f}", goal) : "");
}

/// A part of the table that is made of stages, each with a row of its own, and their sum; returns the sum.
double PrintStages(const std::string& part, const std::vector<const char*>& stages, double goal,
                   const StageClock& clock) {
  for (const char* stage : stages)
    if (const double seconds = clock.Of({stage}); seconds > 0)
      PrintRow(fmt::format("  {}", stage), seconds, clock.points(), 0);
  PrintRow(part, clock.Of(stages), clock.points(), goal);
  return clock.Of(stages);
}

double PeakMB() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Plans a job on one thread and prints what it took; goals are those for the panel, ms a point.
Cost Measure(const fs::path& job, const std::vector<Override>& overrides) {
  const Scratch out;
  StageClock clock;
  const auto before = CpuSeconds();
  const Cost cost = RunOnce(Arguments(job, out.path(), overrides, 1), clock);
  auto parts = CpuSeconds();
  for (size_t i = 0; i < kCpuParts; ++i) parts[i] -= before[i];

  const double optima = parts[static_cast<size_t>(CpuPart::kOptima)];
  const double interference = parts[static_cast<size_t>(CpuPart::kInterference)];
  const std::vector<const char*> ways = {"directions", "passes", "other stations", "finer passes",
                                         "other ways", "ends",   "passes again",   "faces"};
  const double passes = clock.Of(ways), gaps = clock.Of({"gaps", "starts"});
  const size_t points = cost.points;
  fmt::print("{}, {} points, one thread\n  {:<48} {:>9} {:>9} {:>7}\n", job.parent_path().filename().string(),
             points, "part", "CPU s", "ms/point", "goal");
  PrintRow("per-point optima and table", optima, points, 0.25);
  PrintRow("interference of nodes and motions", interference, points, 0.45);
  PrintRow("directions, ladder search, refinement, smoothing", passes - optima - interference, points, 0.25);
  PrintRow("  of it directions", clock.Of({"directions"}), points, 0);
  PrintStages("gaps", {"gaps", "starts"}, 0.2, clock);
  PrintRow("planning", passes + gaps, points, 1.15);
  const double beside = PrintStages("import, gouges, report",
                                    {"read", "surface", "toolpath", "gouges", "engagement", "stations",
                                     "stock", "fixed rotations", "report"},
                                    0.15, clock);
  const double programs = PrintStages("programs written, read back, replayed", {"programs"}, 0.3, clock);
  PrintRow("outside of all stages", cost.cpu - passes - gaps - beside - programs, points, 0);
  PrintRow("all", cost.cpu, points, 1.6);
  fmt::print("  peak memory so far {:.0f} MB (goal 1000)\n", PeakMB());
  return cost;
}

struct Sample {
  fs::path job;
  std::vector<Override> overrides;
};

/// The panel with about `points` points: step-over and spacing shrink alike.
Sample Panel(double points) {
  const double finer = std::sqrt(2386 / points);
  return {fs::path(SourceDir()) / "toolpaths/cabin_panel/job.yaml",
          {{"toolpath.stepover_mm", fmt::format("{:.3f}", 20 * finer)},
           {"toolpath.spacing_mm", fmt::format("{:.3f}", 10 * finer)}}};
}

/// Wall time on two threads: 7 s and 70 s at 10,000 and 100,000 points are the goals.
void MeasureTwoThreads(const Sample& sample, const Cost& one) {
  const Scratch out;
  StageClock clock;
  const Cost two = RunOnce(Arguments(sample.job, out.path(), sample.overrides, 2), clock);
  fmt::print("  two threads: {:.1f} s of wall (goal {:.1f}), {:.2f} times as fast as one (goal 1.75)\n",
             two.wall, 7e-4 * static_cast<double>(two.points), one.wall / two.wall);
}

void MeasurePanels(const std::vector<double>& sizes) {
  std::vector<Cost> costs;
  for (const double points : sizes) {
    const Sample sample = Panel(points);
    costs.push_back(Measure(sample.job, sample.overrides));
    MeasureTwoThreads(sample, costs.back());
  }
  if (costs.size() < 2) return;
  const Cost &first = costs.front(), &last = costs.back();
  fmt::print("growth of CPU time from {} to {} points: exponent {:.3f} (goal 1.05)\n", first.points,
             last.points,
             std::log(last.cpu / first.cpu) /
                 std::log(static_cast<double>(last.points) / static_cast<double>(first.points)));
}

/// Writes the cell with a clamp at this place and a value of how well its tool is known, which reports alone
/// read.
fs::path WriteCellFile(const fs::path& folder, double tip_uncertainty, const char* clamp) {
  std::ifstream from(fs::path(SourceDir()) / "cells/kr500_r2830.yaml");
  const fs::path file = folder / "cell.yaml";
  std::ofstream to(file);
  for (std::string line; std::getline(from, line);) {
    if (line.starts_with("excluded_pairs:")) {
      to << "  - {name: clamp, class: fixture, mount: world, shape: {box: {size_mm: [60, 60, 60]}}, "
            "pose: {xyz_mm: "
         << clamp << "}}\n";
    }
    to << line << '\n';
    if (line == "tool:") to << "  tip_uncertainty_mm: " << tip_uncertainty << '\n';
  }
  return file;
}

// Where the arm never is; beside ways between passes; beside passes.
constexpr const char *kAside = "[-2200, 2200, 400]", *kStillAside = "[-2200, 2300, 400]",
                     *kBesideWays = "[1300, -1300, 600]", *kBesidePasses = "[1750, -640, 1000]";

/// CPU of planning again after changes, each of the plan before.
void MeasureEdits() {
  const Scratch out;
  const Sample sample = Panel(kPointsOfEdits);
  fs::create_directories(out.path());
  std::vector<Override> overrides = sample.overrides;
  overrides.push_back({"cell", WriteCellFile(out.path(), 0.1, kAside).string()});
  const auto plan = [&](const char* what, double goal) {
    StageClock clock;
    const Cost cost = RunOnce(Arguments(sample.job, out.path() / "out", overrides, 1), clock);
    fmt::print("  {:<48} {:>9.2f} {:>9} {:>7}\n", what, cost.cpu, "",
               goal > 0 ? fmt::format("{:.1f}", goal) : "");
  };
  fmt::print("changes of a plan that stands, about {} points\n  {:<48} {:>9} {:>9} {:>7}\n", kPointsOfEdits,
             "changed", "CPU s", "", "goal");
  plan("everything", 0);
  plan("nothing", 0.3);
  WriteCellFile(out.path(), 0.2, kAside);
  plan("a key of reports (tool.tip_uncertainty_mm)", 0.5);
  overrides.push_back({"program_options.path_tolerance_mm", "0.03"});
  plan("a program option (path_tolerance_mm)", 2);
  overrides.push_back({"process.min_feed_share", "0.4"});
  plan("process.min_feed_share", 0.5);
  WriteCellFile(out.path(), 0.2, kStillAside);
  plan("a clamp, moved where the arm never is", 3);
  WriteCellFile(out.path(), 0.2, kBesideWays);
  plan("a clamp, moved beside ways between passes", 3);
  WriteCellFile(out.path(), 0.2, kBesidePasses);
  plan("a clamp, moved beside some passes", 0);
  WriteCellFile(out.path(), 0.2, kBesideWays);
  plan("the same clamp, put back", 1);
}

}  // namespace
}  // namespace millpose

int main(int argc, char** argv) {
  using namespace millpose;
  if (argc == 1) {
    MeasurePanels({2e3, 1e4, 1e5});
    MeasureEdits();
  } else if (std::string(argv[1]) == "edits") {
    MeasureEdits();
  } else if (std::string(argv[1]).ends_with(".yaml")) {
    std::vector<Override> overrides;
    for (int i = 2; i < argc; ++i) overrides.push_back(ParseOverride(argv[i]));
    Measure(argv[1], overrides);
  } else {
    std::vector<double> sizes;
    for (int i = 1; i < argc; ++i) sizes.push_back(std::stod(argv[i]));
    MeasurePanels(sizes);
  }
}
