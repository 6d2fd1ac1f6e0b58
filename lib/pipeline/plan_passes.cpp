// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan_passes.hpp"

#include <atomic>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/parallel.hpp"
#include "base/process.hpp"
#include "pipeline/assemble.hpp"

namespace millpose {
namespace {

void Append(const Eigen::Vector3d& vector, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(vector.data()), sizeof(double) * 3);
}

std::string PassKey(const std::string& context, const Pass& pass, size_t number, size_t first_point) {
  std::string bytes =
      context + fmt::format("\npass {} from {} closed {}\n", number, first_point, pass.closed);
  Append(pass.rotation_reference, &bytes);
  for (const MillingPoint& point : pass.points) {
    for (const Eigen::Vector3d& vector : {point.position, point.normal, point.feed, point.tool_axis})
      Append(vector, &bytes);
    bytes += fmt::format("{} {} {} {} {} {};", point.feed_rate, point.arc_length,
                         static_cast<int>(point.kind), point.region, point.source_line, point.gouge);
  }
  return Hash(bytes);
}

std::string GapKey(const std::string& context, const GapOptions& options, const GapEnd& from,
                   const GapEnd& to) {
  std::string bytes = context + fmt::format("\ngap {} {} {} {} {} {}\n", options.retract,
                                            options.max_iterations, options.swept_resolution,
                                            options.limit_margin, options.speed_share, options.seed);
  for (const GapEnd& end : {from, to}) {
    bytes += fmt::format("{} {} ", end.pass, end.piece);
    bytes.append(reinterpret_cast<const char*>(end.q.data()), sizeof(double) * 6);
  }
  return Hash(bytes);
}

// What `parse` reads from the checkpoint, if there is one. One that cannot be read is as good as none.
template <class Parse>
auto Resume(const OutputFolder& folder, const std::string& key, const Parse& parse)
    -> std::optional<decltype(parse(key, key))> {
  const std::optional<std::string> bytes = folder.ReadCheckpoint(key);
  if (!bytes) return std::nullopt;
  try {
    return parse(*bytes, key);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

// Everything but what only later stages read.
std::string PlanContext(const JobInputs& inputs) {
  JobSettings job = inputs.job;
  const JobSettings later;
  job.name.clear();
  job.file.clear();
  job.cell_file.clear();  // what the files hold counts, not where they stand
  job.workpiece.mesh_file.clear();
  job.workpiece.stock_file.clear();
  job.workpiece.allowance = AllowanceOf(inputs.job);
  job.toolpath = later.toolpath;
  job.toolpath.ends = inputs.job.toolpath.ends;  // of the leads where a pass is split
  job.toolpath.spacing = inputs.job.toolpath.spacing;
  job.feed = later.feed;
  job.feed_policy = later.feed_policy;
  job.spindle_speed = later.spindle_speed;
  job.retract = later.retract;
  job.gap_limit_margin = later.gap_limit_margin;
  job.gap_iterations = later.gap_iterations;
  job.gap_speed_share = later.gap_speed_share;
  job.approach_feed = later.approach_feed;
  job.approach_slow = later.approach_slow;
  job.retract_feed = later.retract_feed;
  job.program_options = later.program_options;
  job.programs_line = later.programs_line;
  job.programs = later.programs;
  CellSettings cell = inputs.cell;
  cell.name.clear();
  cell.controllers.clear();
  std::string context = ProgramId() + '\0' + WriteJob(job) + '\0' + WriteCell(cell) + '\0' +
                        Hash(inputs.workpiece_bytes) + '\0' + Hash(inputs.stock_bytes);
  for (const auto& [name, bytes] : inputs.body_bytes) context += '\0' + name + '\0' + Hash(bytes);
  return context;
}

PlannedPasses PlanPasses(const PoseProblem& problem, const World& world, const Toolpath& toolpath,
                         const PathOptions& options, const std::string& context, const OutputFolder& folder,
                         const Share& share, int threads, Progress& progress, std::stop_token stop) {
  const size_t count = toolpath.passes.size();
  std::vector<size_t> first_points(count, 0);
  for (size_t i = 1; i < count; ++i)
    first_points[i] = first_points[i - 1] + toolpath.passes[i - 1].points.size();

  // A job of few passes spends its threads inside them.
  const int inner_threads = count >= static_cast<size_t>(threads) ? 1 : threads;
  PlannedPasses planned;
  planned.passes.resize(count);
  std::atomic<size_t> resumed = 0;
  ParallelFor(count, threads, stop, [&](size_t i) {
    if (i % share.count != share.index) return;
    const Pass& pass = toolpath.passes[i];
    const std::string key = PassKey(context, pass, i, first_points[i]);
    if (std::optional<PassResult> earlier = Resume(folder, key, ParsePassResult)) {
      planned.passes[i] = std::move(*earlier);
      ++resumed;
    } else {
      planned.passes[i] =
          PlanPass(problem, world, pass, static_cast<int>(i), first_points[i], options, inner_threads, stop);
      folder.WriteCheckpoint(key, Serialise(planned.passes[i]));
    }
    progress.Advance(pass.points.size());
  });
  planned.resumed = resumed;
  return planned;
}

PlannedGaps PlanGaps(const World& world, const std::vector<std::pair<GapEnd, GapEnd>>& ends,
                     const GapOptions& options, const std::string& context, const OutputFolder& folder,
                     int threads, Progress& progress, std::stop_token stop) {
  PlannedGaps planned;
  planned.gaps.resize(ends.size());
  std::atomic<size_t> resumed = 0;
  ParallelFor(ends.size(), threads, stop, [&](size_t i) {
    const auto& [from, to] = ends[i];
    const std::string key = GapKey(context, options, from, to);
    if (std::optional<Gap> earlier = Resume(folder, key, ParseGap)) {
      planned.gaps[i] = std::move(*earlier);
      ++resumed;
    } else {
      planned.gaps[i] = PlanGap(world, from, to, options, stop);
      folder.WriteCheckpoint(key, Serialise(planned.gaps[i]));
    }
    progress.Advance(1);
  });
  planned.resumed = resumed;
  return planned;
}

}  // namespace millpose
