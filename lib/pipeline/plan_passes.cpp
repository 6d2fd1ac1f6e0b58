// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan_passes.hpp"

#include <atomic>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/parallel.hpp"

namespace millpose {
namespace {

void Append(const Eigen::Vector3d& vector, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(vector.data()), sizeof(double) * 3);
}

std::string CheckpointKey(const std::string& context, const Pass& pass, size_t number, size_t first_point) {
  std::string bytes =
      context + fmt::format("\npass {} from {} closed {}\n", number, first_point, pass.closed);
  Append(pass.rotation_reference, &bytes);
  for (const MillingPoint& point : pass.points) {
    for (const Eigen::Vector3d& vector : {point.position, point.normal, point.feed, point.tool_axis})
      Append(vector, &bytes);
    bytes += fmt::format("{} {} {} {} {};", point.feed_rate, point.arc_length, static_cast<int>(point.kind),
                         point.region, point.source_line);
  }
  return Hash(bytes);
}

// A checkpoint that cannot be read is as good as none: the pass is planned again.
std::optional<PassResult> Resume(const OutputFolder& folder, const std::string& key) {
  const std::optional<std::string> bytes = folder.ReadCheckpoint(key);
  if (!bytes) return std::nullopt;
  try {
    return ParsePassResult(*bytes, key);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

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
    const std::string key = CheckpointKey(context, pass, i, first_points[i]);
    if (std::optional<PassResult> earlier = Resume(folder, key)) {
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

}  // namespace millpose
