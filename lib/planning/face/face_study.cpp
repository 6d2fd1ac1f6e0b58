// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/face_study.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "base/random.hpp"
#include "base/rotation.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kAbove = 5;  // mm over the cutter's radius within which material is looked for

/// Uniform in the unit ball.
Vector3d InBall(RandomStream& random) {
  for (;;) {
    const double x = random.Uniform(-1, 1), y = random.Uniform(-1, 1), z = random.Uniform(-1, 1);
    Vector3d v(x, y, z);
    if (v.squaredNorm() <= 1) return v;
  }
}

/// The tool as it is expected to err.
ToolErrors Expected(const StatedErrors& stated) {
  ToolErrors errors;
  errors.force = stated.force ? 1 : 0;
  if (stated.lost) errors.lost = *stated.lost;
  errors.geometry = stated.geometry;
  return errors;
}

/// One that is as likely as any other within the bounds. Every draw takes the same numbers from its stream,
/// whatever is stated of force, lost motion and tool.
ToolErrors Drawn(const StatedErrors& stated, uint64_t seed, size_t draw) {
  RandomStream random(seed, draw);
  ToolErrors errors = Expected(stated);
  errors.force *= std::max(0.0, 1 + stated.force_share * random.Uniform(-1, 1));
  const Vector3d turn = stated.force_angle * InBall(random);
  if (turn.norm() > 0) errors.force_turn = RotationAbout(turn.normalized(), turn.norm());
  for (Eigen::Index i = 0; i < kMostGears; ++i) errors.lost.width[i] *= random.Uniform();
  errors.tip = stated.tip * InBall(random);
  errors.lean = stated.lean * InBall(random);
  if (stated.gears) {
    errors.gears = *stated.gears;
    for (int i = 0; i < 6; ++i) errors.gears.phase[i] = random.Uniform(-kPi, kPi);
  }
  if (stated.part) {
    ProbeVector normal(stated.part->cols());
    for (Eigen::Index i = 0; i < normal.size(); ++i) normal[i] = random.Normal();
    const ProbeVector moved = *stated.part * normal;
    errors.part_shift = moved.head<3>();
    errors.part_turn = moved.segment<3>(3);
    errors.part_centre = stated.part_centre;
    errors.part_bending = stated.part_bending;
    errors.part_bending.modes.assign(moved.data() + 6, moved.data() + moved.size());
  }
  return errors;
}

double ShareOf(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(at);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

DrawnInterval IntervalOf(std::vector<double> values) {
  std::ranges::sort(values);
  return {ShareOf(values, 0.05), ShareOf(values, 0.95)};
}

class Study {
 public:
  Study(const ErringPath& path, const CutterShape& cutter, const StatedErrors& stated,
        const FaceStudyOptions& options, const Execution& execution)
      : path_(path), cutter_(cutter), stated_(stated), options_(options), execution_(execution) {}

  SweptCutter Swept(const ToolErrors& errors) const {
    return {cutter_, path_.Motions(errors), cutter_.radius + kAbove};
  }

  CutFace Cut(const FaceRays& rays, const ToolErrors& errors, const std::vector<RayHeight>* flawless,
              bool zone) const {
    const SweptCutter swept = Swept(errors);
    CutFace face;
    face.heights = HeightsOn(swept, rays, execution_.Threads());
    face.figures = FiguresOf(rays, face.heights, flawless ? *flawless : face.heights, swept.motions(), zone);
    return face;
  }

  /// What stands; where that would be higher than the stock, nothing is cut.
  std::vector<RayHeight> HeightsOn(const SweptCutter& swept, const FaceRays& rays, int threads) const {
    std::vector<RayHeight> heights = swept.HeightsOn(rays.rays, threads, execution_.stop);
    for (RayHeight& height : heights)
      if (height.height > options_.top) height = {};
    return heights;
  }

  DrawnFaces Draw(const FaceRays& rays) const {
    const std::vector<RayHeight> flawless = Cut(rays, {}, nullptr, false).heights;
    DrawnFaces drawn;
    drawn.count = options_.draws;
    drawn.rays = rays.rays.size();
    drawn.expected = Cut(rays, Expected(stated_), &flawless, false).figures;
    std::vector<FaceFigures> faces(static_cast<size_t>(options_.draws));
    ParallelFor(faces.size(), execution_.Threads(), execution_.stop, [&](size_t i) {
      const SweptCutter swept = Swept(Drawn(stated_, options_.seed, i));
      faces[i] = FiguresOf(rays, HeightsOn(swept, rays, 1), flawless, swept.motions(), false);
    });
    const auto interval = [&](auto figure) {
      std::vector<double> values;
      for (const FaceFigures& face : faces) values.push_back(figure(face));
      return IntervalOf(std::move(values));
    };
    drawn.level = interval([](const FaceFigures& face) { return face.heights.level; });
    drawn.added = interval([](const FaceFigures& face) { return face.added.high - face.added.low; });
    if (std::ranges::all_of(faces, [](const FaceFigures& face) { return face.flatness.has_value(); }))
      drawn.flatness = interval([](const FaceFigures& face) { return *face.flatness; });
    return drawn;
  }

 private:
  const ErringPath& path_;
  const CutterShape& cutter_;
  const StatedErrors& stated_;
  const FaceStudyOptions& options_;
  const Execution& execution_;
};

}  // namespace

FaceStudy StudyFace(const ErringPath& path, const CutterShape& cutter, const FaceRays& rays,
                    const FaceRays& few, const StatedErrors& stated, const FaceStudyOptions& options,
                    const Execution& execution) {
  const Study study(path, cutter, stated, options, execution);
  FaceStudy result;
  result.flawless = study.Cut(rays, {}, nullptr, true);
  const std::vector<RayHeight>& flawless = result.flawless.heights;
  const ToolErrors all = Expected(stated);
  ToolErrors force, lost, geometry;
  force.force = all.force;
  lost.lost = all.lost;
  geometry.geometry = all.geometry;
  result.expected = study.Cut(rays, all, &flawless, true);
  const auto alone = [&](const ToolErrors& errors, bool only) {
    return only ? result.expected.figures : study.Cut(rays, errors, &flawless, true).figures;
  };
  const bool one = stated.force + stated.lost.has_value() + stated.geometry == 1;
  if (stated.force) result.by_force = alone(force, one);
  if (stated.lost) result.by_lost = alone(lost, one);
  if (stated.geometry) result.by_geometry = alone(geometry, one);
  if (options.draws > 0 && stated.AreUnsure()) result.drawn = study.Draw(few);
  return result;
}

}  // namespace millpose
