// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_march.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;

constexpr double kMarchStep = 2;            // cells
constexpr double kTightestTurn = 0.4;       // radius of a turn towards the material, in the disc's
constexpr double kSharpest = DegToRad(70);  // turn of a step away from it
constexpr int kTurns = 16;                  // that are tried
constexpr int kHalvings = 5;
constexpr int kStartDirections = 48;
constexpr size_t kMostSteps = 400'000;

Vector2d TurnedBy(const Vector2d& direction, double angle) {
  const SineCosine turn = SinCos(angle);
  return {turn.cos * direction.x() - turn.sin * direction.y(),
          turn.sin * direction.x() + turn.cos * direction.y()};
}

class Marcher {
 public:
  Marcher(RoughMaterial& material, const RoughRoom& room, const RoughMarchOptions& options)
      : material_(material),
        room_(room),
        options_(options),
        step_(kMarchStep * material.grid().cell),
        away_(options.climb ? 1 : -1) {}

  RoughCut Run(const Vector2d& place, const Vector2d& direction) {
    RoughCut cut;
    cut.way = {place};
    material_.BeginCut();
    Vector2d heading = direction;
    double idle = 0;
    size_t useful = 0;
    while (cut.way.size() < kMostSteps && idle < material_.radius()) {
      const std::optional<double> turn = Turn(cut.way.back(), heading);
      if (!turn) break;
      heading = TurnedBy(heading, *turn).normalized();
      const Vector2d next = cut.way.back() + step_ * heading;
      const size_t before = cut.taken.size();
      material_.Sweep(cut.way.back(), next, cut.taken);
      cut.way.push_back(next);
      idle += step_;
      if (cut.taken.size() > before) idle = 0, useful = cut.way.size();
    }
    cut.way.resize(std::max<size_t>(useful, 1));
    material_.BeginCut();
    return cut;
  }

 private:
  bool Allowed(const Vector2d& from, const Vector2d& heading, double turn) const {
    const Vector2d direction = TurnedBy(heading, turn), place = from + step_ * direction;
    return room_.Allows(place) && material_.Meet(place, direction).angle <= options_.engagement;
  }

  /// The turn nearest to the material that is allowed.
  std::optional<double> Turn(const Vector2d& from, const Vector2d& heading) const {
    const double towards = -away_ * step_ / (kTightestTurn * material_.radius());
    const double range = away_ * kSharpest - towards;
    double refused = towards, allowed = towards;
    int i = 0;
    for (; i <= kTurns; ++i) {
      allowed = towards + range * i / kTurns;
      if (Allowed(from, heading, allowed)) break;
      refused = allowed;
    }
    if (i > kTurns) return std::nullopt;
    for (int k = 0; i > 0 && k < kHalvings; ++k) {
      const double middle = (refused + allowed) / 2;
      (Allowed(from, heading, middle) ? allowed : refused) = middle;
    }
    return allowed;
  }

  RoughMaterial& material_;
  const RoughRoom& room_;
  const RoughMarchOptions& options_;
  double step_, away_;
};

}  // namespace

std::optional<Vector2d> RoughStart(const RoughMaterial& material, const RoughRoom& room,
                                   const RoughMarchOptions& options, const Vector2d& place) {
  std::optional<Vector2d> best;
  double most = 0;
  for (int i = 0; i < kStartDirections; ++i) {
    const SineCosine turn = SinCos(2 * kPi * i / kStartDirections);
    const Vector2d direction(turn.cos, turn.sin),
        next = place + kMarchStep * material.grid().cell * direction;
    if (!room.Allows(next)) continue;
    const RoughMaterial::Contact contact = material.Meet(next, direction);
    if (contact.angle > options.engagement || contact.angle <= most) continue;
    if (options.climb ? contact.side > 0 : contact.side < 0) continue;
    best = direction, most = contact.angle;
  }
  return best;
}

RoughCut RoughMarch(RoughMaterial& material, const RoughRoom& room, const RoughMarchOptions& options,
                    const Vector2d& place, const Vector2d& direction) {
  return Marcher(material, room, options).Run(place, direction);
}

}  // namespace millpose
