// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/world.hpp"

#include <cassert>
#include <set>

#include "base/error.hpp"
#include "machine/collision/body_pairs.hpp"
#include "machine/collision/cutter.hpp"
#include "machine/collision/world_impl.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

bool OnTool(BodyClass c) {
  return c == BodyClass::kCutter || c == BodyClass::kHolder || c == BodyClass::kSpindle;
}

/// The motion, in W, of what external axis `axis` carries.
Pose CarriageMoved(const Cell& cell, int axis) {
  if (cell.external.empty()) return Pose::Identity();
  return Mechanism(cell.external_axes).MovedWith(static_cast<size_t>(axis), cell.external);
}

/// Pose of the body's shape in its link, or in W when it stands still.
Pose PoseOnLink(const Cell& cell, const Body& body) {
  switch (body.mount) {
    case Mount::kTool:
      return ToolOnFlange(cell) * body.X_MG;
    case Mount::kWorkpiece:
      return cell.X_WP * body.X_MG;
    case Mount::kLink:
      return body.link == 0 ? cell.X_WB * body.X_MG : body.X_MG;
    case Mount::kCarriage:
      return CarriageMoved(cell, body.axis) * body.X_MG;
    case Mount::kWorld:
      break;
  }
  return body.X_MG;
}

/// All that is wrong with the cell's bodies and exclusions.
std::vector<Problem> FindProblems(const Cell& cell) {
  std::vector<Problem> problems;
  const auto report = [&](std::string message) {
    problems.push_back({SourceLocation{fmt::format("cell '{}'", cell.name)}, std::move(message)});
  };
  std::vector<std::string> names;
  for (const Body& body : cell.bodies) {
    if (std::find(names.begin(), names.end(), body.name) != names.end()) {
      report(fmt::format("two bodies are named '{}'; names must differ", body.name));
    }
    names.push_back(body.name);
    if (const std::string problem = ShapeProblem(body.shape); !problem.empty()) {
      report(fmt::format("body '{}': {}", body.name, problem));
    }
    if (body.mount == Mount::kLink && (body.link < 0 || body.link > 6)) {
      report(fmt::format("body '{}' is mounted on link {}; links are 0 (base) to 6 (flange)", body.name,
                         body.link));
    }
    if (body.body_class == BodyClass::kCutter && body.mount != Mount::kTool) {
      report(fmt::format("body '{}' is a cutter and must be mounted on the tool", body.name));
    }
    if (!body.X_MG.matrix().allFinite()) report(fmt::format("body '{}': its pose is not finite", body.name));
  }
  for (const auto& [first, second] : cell.excluded_pairs) {
    for (const std::string& name : {first, second}) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      const std::string nearest = NearestName(name, names);
      report(fmt::format("excluded_pairs: there is no body '{}'{}", name,
                         nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
    }
  }
  for (const double clearance : {cell.clearances.free, cell.clearances.cutting, cell.allowance}) {
    if (!(std::isfinite(clearance) && clearance >= 0)) {
      report(fmt::format("clearance {} mm: must be 0 or more", clearance));
    }
  }
  return problems;
}

/// Lower is checked earlier: the tool at the part, the tool elsewhere, outer links, inner links.
int Rank(const Body& a, const Body& b) {
  const bool tool = OnTool(a.body_class) || OnTool(b.body_class);
  const auto of_part = [](const Body& body) {
    return body.body_class == BodyClass::kWorkpiece || body.body_class == BodyClass::kStock;
  };
  const bool part = of_part(a) || of_part(b);
  return (tool ? 0 : 20) + (part ? 0 : 10) + 6 - std::max(LinkOf(a), LinkOf(b));
}

/// World::Impl::span.
double SpanOf(const Arm& arm, const std::vector<WorldBody>& bodies) {
  constexpr double kAsBuilt = 1.01;  // an arm's links are a little longer or shorter than its model's
  double beyond = 0;                 // of the link that it hangs on
  for (const WorldBody& body : bodies)
    if (body.link > 0) beyond = std::max(beyond, (body.X_LG * body.part->centre).norm() + body.part->radius);
  return kAsBuilt * (ArmLength(arm) + beyond);
}

}  // namespace

std::shared_ptr<const World::Impl> World::Impl::Build(Cell cell) {
  auto impl = std::make_shared<Impl>();
  std::set<std::pair<std::string, std::string>> excluded;
  for (const auto& [a, b] : cell.excluded_pairs) {
    excluded.emplace(a, b);
    excluded.emplace(b, a);
  }
  for (const Body& body : cell.bodies) {
    impl->bodies.push_back({body.name, std::make_shared<const FclPart>(MakePart(body.shape)), LinkOf(body),
                            PoseOnLink(cell, body)});
  }
  impl->span = SpanOf(cell.arm, impl->bodies);
  std::vector<std::pair<int, BodyPair>> ranked;
  for (size_t i = 0; i < cell.bodies.size(); ++i) {
    for (size_t j = i + 1; j < cell.bodies.size(); ++j) {
      const Body &a = cell.bodies[i], &b = cell.bodies[j];
      if (MeetInArm(a, b) || excluded.contains({a.name, b.name})) continue;
      for (const BodyPair& pair : impl->PairsOf(cell, static_cast<int>(i), static_cast<int>(j))) {
        ranked.emplace_back(Rank(a, b), pair);
        ranked.back().second.kind = impl->KindOf(cell, pair);
      }
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [rank, pair] : ranked) impl->pairs.push_back(pair);
  impl->meshes_ = std::make_shared<const Cell>(cell);
  for (Body& body : cell.bodies)
    if (std::holds_alternative<Triangles>(body.shape)) body.shape = Triangles{};
  impl->without_meshes_ = std::make_shared<const Cell>(std::move(cell));
  impl->cell = *impl->without_meshes_;
  return impl;
}

std::vector<BodyPair> World::Impl::PairsOf(const Cell& source, int i, int j) {
  const double free = source.clearances.free, cutting = source.clearances.cutting + source.allowance;
  const bool swap = bodies[i].link > bodies[j].link;
  const int first = swap ? j : i, second = swap ? i : j;
  const Body &still = source.bodies[first], &moving = source.bodies[second];
  BodyPair pair{first, second, {free, free}};
  // What of the stock stands around the tool in a cut, the cuts before have taken off.
  if (still.body_class == BodyClass::kStock && OnTool(moving.body_class)) pair.clearance[1].reset();
  if (still.body_class != BodyClass::kWorkpiece) return {pair};
  pair.clearance = {free + source.allowance, free + source.allowance};
  if (!OnTool(moving.body_class)) return {pair};
  if (moving.body_class != BodyClass::kCutter) {
    pair.clearance[1] = cutting;
    return {pair};
  }
  pair.clearance[1].reset();
  const Pose X_TG = ToolOnFlange(source).inverse(Eigen::Isometry) * bodies[second].X_LG;
  const std::optional<Convex> above = AboveHeight(moving.shape, X_TG, source.cutter_length);
  if (!above || !ShapeProblem(*above).empty()) return {pair};  // nothing, or a sliver without volume
  const BodyPair shank{first, static_cast<int>(bodies.size()), {std::nullopt, cutting}};
  bodies.push_back({fmt::format("{} above its cutting length", moving.name),
                    std::make_shared<const FclPart>(MakePart(*above)), 6, ToolOnFlange(source)});
  return {pair, shank};
}

PointMemory::Kind World::Impl::KindOf(const Cell& source, const BodyPair& pair) const {
  using Kind = PointMemory::Kind;
  const WorldBody &first = bodies[pair.first], &second = bodies[pair.second];
  if (second.link <= 3) return Kind::kArm;
  if (second.link < 6 || first.link > 0) return Kind::kOther;
  // A frustum counts as the polyhedron that it is checked as: not round.
  const Shape& shape = second.part->shape;
  const bool round = std::holds_alternative<Sphere>(shape) || std::holds_alternative<Cylinder>(shape) ||
                     std::holds_alternative<Capsule>(shape);
  const Pose X_TG = ToolOnFlange(source).inverse(Eigen::Isometry) * second.X_LG;
  constexpr double kOnAxis = 1e-9;  // mm, and of a direction
  const bool about_axis =
      X_TG.translation().head<2>().norm() < kOnAxis &&
      (std::holds_alternative<Sphere>(shape) || X_TG.linear().col(2).head<2>().norm() < kOnAxis);
  return round && about_axis ? Kind::kTool : Kind::kFlange;
}

void World::Impl::Replace() {
  // A world has the cell's bodies in their order, then those that it made itself, which hang on the tool.
  for (size_t i = 0; i < cell.bodies.size(); ++i) bodies[i].X_LG = PoseOnLink(cell, cell.bodies[i]);
}

std::shared_ptr<World::Impl> World::Impl::Copy() const {
  auto copy = std::make_shared<Impl>();
  copy->cell = *without_meshes_;
  copy->cell.external = cell.external;
  copy->cell.X_WB = cell.X_WB, copy->cell.X_WP = cell.X_WP;
  copy->bodies = bodies;
  copy->pairs = pairs;
  copy->measures_all = measures_all;
  copy->meshes_ = meshes_, copy->without_meshes_ = without_meshes_;
  copy->later_ = std::make_shared<Later>();
  return copy;
}

const Cell& World::Impl::Whole() const {
  if (!later_) return *meshes_;
  std::call_once(later_->once, [&] {
    later_->cell = *meshes_;
    later_->cell.external = cell.external;
    later_->cell.X_WB = cell.X_WB, later_->cell.X_WP = cell.X_WP;
  });
  return later_->cell;
}

World::World(Cell cell) {
  std::vector<Problem> problems = FindProblems(cell);
  if (!problems.empty()) throw InputError(std::move(problems));
  impl_ = Impl::Build(std::move(cell));
}

World::World(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

World::~World() = default;

World World::Recording(std::shared_ptr<QueryLog> keeper) const {
  World watched = *this;
  watched.keeper_ = std::move(keeper);
  return watched;
}

World World::With(const Pose& X_WB, const Pose& X_WP) const {
  const std::shared_ptr<Impl> moved = impl_->Copy();
  moved->cell.X_WB = X_WB;
  moved->cell.X_WP = X_WP;
  moved->Replace();
  return World(moved);
}

World World::At(const ExternalPosition& external) const {
  const Cell& still = impl_->cell;
  assert(still.external.empty() && external.size() == still.external_axes.size());
  if (external.empty()) return *this;
  const Mechanism mechanism(still.external_axes);
  const std::shared_ptr<Impl> moved = impl_->Copy();
  moved->cell.external = external;
  moved->cell.X_WB = mechanism.Moved(Carries::kRobot, external) * still.X_WB;
  moved->cell.X_WP = mechanism.Moved(Carries::kWorkpiece, external) * still.X_WP;
  moved->Replace();
  return World(moved);
}

World World::MeasuringAll() const {
  const std::shared_ptr<Impl> measuring = impl_->Copy();
  measuring->measures_all = true;
  return World(measuring);
}

std::vector<std::string> World::TouchedBy(Mount mount) const {
  const std::vector<Body>& bodies = impl_->cell.bodies;
  std::vector<std::string> touched;
  for (size_t i = 0; i < bodies.size(); ++i) {
    if (LinkOf(bodies[i]) != 0 || bodies[i].mount == mount) continue;
    const Placed still = PlacePart(*impl_->bodies[i].part, impl_->bodies[i].X_LG);
    for (size_t j = 0; j < bodies.size(); ++j) {
      if (LinkOf(bodies[j]) != 0 || bodies[j].mount != mount) continue;
      const Placed part = PlacePart(*impl_->bodies[j].part, impl_->bodies[j].X_LG);
      constexpr double kNear = 1e-3;  // mm
      if (BoxesApart(still, part, kNear) || DistanceUpTo(still, part, kNear).distance > 0) continue;
      touched.push_back(bodies[i].name);
      break;
    }
  }
  return touched;
}

const Cell& World::cell() const { return impl_->Whole(); }

std::string World::PairName(int pair) const {
  const BodyPair& of = impl_->pairs.at(static_cast<size_t>(pair));
  const auto name = [&](int body) { return impl_->bodies[static_cast<size_t>(body)].name; };
  return name(of.first) + " and " + name(of.second);
}

}  // namespace millpose
