// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_segment.hpp"

#include "base/parallel.hpp"
#include "machine/robot/angles.hpp"
#include "planning/ladder/edge_kernel.hpp"
#include "planning/pass/free_smoothing.hpp"
#include "planning/pass/unwind.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

std::vector<MillingPoint> PointsOf(const PassResult& pass, const Segment& segment) {
  std::vector<MillingPoint> points;
  for (int t = segment.first; t <= segment.last; ++t)
    points.push_back(pass.points[static_cast<size_t>(t)].point);
  return points;
}

PassChecks ChecksOf(const Stations& stations, const PlannedIn& in, const Segment& segment,
                    const FacePlanOptions& options, const Execution& execution) {
  const auto first = static_cast<size_t>(segment.first),
             count = static_cast<size_t>(segment.last) - first + 1;
  return {.world = in.along.empty() ? in.station.world : stations.world(),
          .carrier = in.CarrierAt(first),
          .swept_resolution = options.path.swept_resolution,
          .rotates_first = true,
          .threads = execution.Threads(),
          .stop = execution.stop,
          .along = in.along.empty() ? std::span<const PlaceAlong>()
                                    : std::span<const PlaceAlong>(in.along).subspan(first, count)};
}

std::vector<std::shared_ptr<PointVerdicts>> NoVerdicts(size_t count) {
  std::vector<std::shared_ptr<PointVerdicts>> verdicts;
  for (size_t i = 0; i < count; ++i) verdicts.push_back(std::make_shared<PointVerdicts>());
  return verdicts;
}

/// As MotionWeight() has it of the points' own optima.
double WeightOfMotion(double share, const PassResult& pass) {
  std::vector<double> values;
  for (const PlannedPoint& point : pass.points)
    if (point.skip == Infeasibility::kNone && point.own_optimum > 0) values.push_back(point.own_optimum);
  if (values.empty()) return share;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return share * *middle;
}

}  // namespace

FaceSegment::FaceSegment(const Stations& stations, const PassResult& pass, const Segment& segment,
                         const FacePlanOptions& options, const Execution& execution)
    : pass_(pass),
      segment_(segment),
      options_(options),
      in_(stations, pass),
      model_(ModelOf(stations, options.gears)),
      first_(static_cast<size_t>(segment.first)),
      points_(PointsOf(pass, segment)),
      verdicts_(NoVerdicts(points_.size())),
      checks_(ChecksOf(stations, in_, segment, options, execution)),
      checker_(checks_, verdicts_, options.leave),
      law_(checks_, scorers_, options.path.max_deviation),
      motion_weight_(WeightOfMotion(options.path.motion_share, pass)) {
  std::vector<MillingPoint> on_part;
  for (size_t t = 0; t < points_.size(); ++t) {
    scorers_.emplace_back(ProblemAt(t), points_[t], pass.rotation_reference);
    faces_.emplace_back(ProblemAt(t), model_, points_[t], ExternalAt(pass, first_ + t));
    on_part.push_back(in_.along.empty() ? points_[t] : OnPart(in_.along[first_ + t], points_[t]));
  }
  law_ = BendLaw(checks_, scorers_, options.path.max_deviation);
  max_step_ = StepBoundsAlong(options.path.steps, ProblemAt(0).arm, on_part);
  if (!in_.along.empty()) middles_ = MiddlesAlong(checks_.along, points_);
  const Freedom& freedom = *ProblemAt(0).freedoms[0];
  const double range = freedom.Upper() - freedom.Lower();
  const double places = std::max(1.0, std::ceil(range / options.path.rotation_step - 1e-9));
  step_ = range / places;
  ring_ = freedom.Periodic() ? static_cast<int>(places) : 0;
  ends_ = checker_.ToLeave(AsPlanned().path, segment.closed);
}

FaceCandidate FaceSegment::AsPlanned() const {
  FaceCandidate planned;
  for (size_t t = 0; t < size(); ++t) {
    const PlannedPoint& point = pass_.points[first_ + t];
    planned.path.push_back(
        {{point.freedoms[0]}, point.branch, point.q, point.objective, point.from_genetic, false});
  }
  planned.figures = Figures(planned.path);
  return planned;
}

FaceChoiceFigures FaceSegment::Figures(std::span<const PathNode> path, size_t* worst_at) const {
  std::vector<FacePlace> places;
  for (size_t t = 0; t < path.size(); ++t) places.push_back(faces_[t].At(path[t].q));
  return FiguresOf(options_.gears.lost, std::move(places), closed(), worst_at);
}

FlankNode FaceSegment::NodeAt(size_t t, const Candidate& candidate, int branch, int place,
                              double rotation) const {
  return {branch, place, {rotation}, candidate.q, candidate.objective, faces_[t].At(candidate.q), false};
}

std::vector<std::vector<FlankNode>> FaceSegment::Layers() const {
  std::vector<std::vector<FlankNode>> layers(size());
  ParallelFor(size(), checks_.threads, checks_.stop, [&](size_t t) {
    const CandidateTable table = CandidateTable::OfStep(scorers_[t], step_);
    for (const CandidateTable::Entry& entry : table.entries()) {
      const Candidate candidate{Infeasibility::kNone, entry.objective, 0, entry.q};
      layers[t].push_back(NodeAt(t, candidate, entry.branch, static_cast<int>(entry.setting),
                                 table.Setting(entry.setting)[0]));
    }
    std::ranges::stable_sort(layers[t], {}, [](const FlankNode& node) { return node.branch; });
  });
  return layers;
}

std::vector<FlankNode> FaceSegment::LayerAround(size_t t, double rotation, int branch, double step,
                                                int reach) const {
  std::vector<FlankNode> layer;
  std::vector<double> values(kLanes);
  ScoredBlock block;
  for (int first = -reach; first <= reach; first += static_cast<int>(kLanes)) {
    for (size_t l = 0; l < kLanes; ++l) values[l] = rotation + (first + static_cast<int>(l)) * step;
    scorers_[t].ScoreBlock(values, 1U << (branch & 3), block);
    for (size_t l = 0; l < kLanes && first + static_cast<int>(l) <= reach; ++l) {
      if (block.obstacle[branch][l] != Infeasibility::kNone) continue;
      layer.push_back(NodeAt(t, CandidateOf(block, branch, static_cast<int>(l)), branch,
                             first + static_cast<int>(l), values[l]));
    }
  }
  return layer;
}

FlankRules FaceSegment::Rules() const {
  FlankRules rules{.lost = options_.gears.lost, .max_step = max_step_, .stop = checks_.stop};
  rules.motion_weight = motion_weight_;
  rules.closed = closed();
  return rules;
}

/// Chooses full revolutions; returns whether limits and joint steps admit it.
bool FaceSegment::Connect(std::vector<PathNode>& nodes) const {
  for (size_t t = 0; t < nodes.size(); ++t) {
    const size_t next = t + 1 == nodes.size() ? 0 : t + 1;
    if (next == 0 && !closed()) break;
    const Joints step = (nodes[next].q - nodes[t].q).unaryExpr(&WrapToPi);
    if ((step.cwiseAbs().array() > max_step_[t].array() + kRevolutionRounding).any()) return false;
  }
  return Unwind(nodes, closed(), ProblemAt(0).bounds);
}

std::optional<FaceCandidate> FaceSegment::Join(std::vector<PathNode> nodes) const {
  if (!Connect(nodes)) return std::nullopt;
  FaceCandidate joined{std::move(nodes), {}};
  joined.figures = Figures(joined.path);
  return joined;
}

std::optional<FaceChoiceFigures> FaceSegment::FiguresJoined(std::vector<PathNode> nodes,
                                                            std::vector<FacePlace> faces) const {
  if (!Connect(nodes)) return std::nullopt;
  const LostMotion& lost = options_.gears.lost;
  for (size_t t = 0; t < nodes.size(); ++t) faces[t].gears.place.at.head<6>() = lost.gears * nodes[t].q;
  return FiguresOf(lost, std::move(faces), closed());
}

double FaceSegment::Bend(size_t t, const Joints& from, const Joints& to) const {
  return law_.Bend(t, from, (to - from).unaryExpr(&WrapToPi));
}

SegmentHits FaceSegment::Hits(const FaceCandidate& candidate) {
  const std::vector<PathNode>& path = candidate.path;
  SegmentHits hits = checker_.Check(path, closed(), ends_, std::vector<bool>(size(), false));
  for (size_t t = 0; t < size(); ++t) {
    const size_t next = t + 1 == size() ? 0 : t + 1;
    if (next == 0 && !closed()) break;
    const double most = law_.Most(kSearchedBend, t, path[t].freedoms, path[t].branch, path[t].q);
    if (Bend(t, path[t].q, path[next].q) > most) hits.motion[t] = 1;
  }
  return hits;
}

void FaceSegment::BarBlocked(int branch, const std::vector<bool>& asked,
                             std::vector<std::vector<FlankNode>>& layers) {
  checker_.Each(size(), [&](PassCheckers& checkers, size_t t) {
    if (!asked[t]) return;
    for (FlankNode& node : layers[t])
      if (node.branch == branch && !node.barred) node.barred = !checker_.PoseFree(checkers, t, node.q);
  });
}

FaceCandidate FaceSegment::Smoothed(FaceCandidate candidate) {
  SmoothOptions options;
  options.loss = options_.path.smoothing_loss;
  options.max_step = max_step_;
  options.max_deviation = options_.path.max_deviation;
  options.keep_worst = options_.path.worst_first;
  options.closed = closed();
  options.stop = checks_.stop;
  options.middles = middles_;
  SmoothFree(scorers_, points_, options, checker_, candidate.path);
  candidate.figures = Figures(candidate.path);
  return candidate;
}

}  // namespace millpose
