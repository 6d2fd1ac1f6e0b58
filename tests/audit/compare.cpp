// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <limits>

#include "tests/audit/kinematics.hpp"
#include "tests/audit/programs.hpp"

namespace millpose::audit {
namespace {

using Quaternion = Eigen::Quaternion<Real>;

Vector3 Tip(const Matrix4& X) { return X.block<3, 1>(0, 3); }
Matrix3 Rotation(const Matrix4& X) { return X.block<3, 3>(0, 0); }

/// The tool on the part, and where the external axes are then.
struct Place {
  Matrix4 X;
  std::vector<Real> external;
};

Place PlaceOf(const Target& target) { return {target.X_PT, target.external}; }

std::vector<Real> Between(const std::vector<Real>& from, const std::vector<Real>& to, Real share) {
  std::vector<Real> position = from;
  for (size_t i = 0; i < position.size(); ++i) position[i] += share * (to[i] - from[i]);
  return position;
}

/// How far a pose is from a straight motion of the tool.
struct Off {
  Real position, angle;
  Real share;                  ///< of the way, where it is nearest
  std::vector<Real> external;  ///< how far each external axis is from where it is there: mm or rad
  Real Worst() const { return std::max(position / kPositionBound, angle / kAngleBound); }
};

using Way = std::function<Matrix3(Real)>;

Way Evenly(const Matrix3& from, const Matrix3& to) {
  return [first = Quaternion(from), last = Quaternion(to)](Real share) -> Matrix3 {
    return first.slerp(share, last).toRotationMatrix();
  };
}

/// One direction of the tool on a great circle, the tool evenly about it.
Way Swivelling(const Matrix3& from, const Matrix3& to, const Vector3& direction) {
  const Vector3 first = from * direction, last = to * direction, across = first.cross(last);
  const Real angle = std::atan2(across.norm(), first.dot(last));
  const Vector3 axis = across.norm() > 0 ? Vector3(across.normalized()) : first.unitOrthogonal();
  const auto swung = [=](Real share) -> Matrix3 {
    return Eigen::AngleAxis<Real>(share * angle, axis).toRotationMatrix();
  };
  const Way turned = Evenly(Matrix3::Identity(), from.transpose() * swung(1).transpose() * to);
  return [=](Real share) -> Matrix3 { return swung(share) * from * turned(share); };
}

/// How the tool may turn on the way to a target.
std::vector<Way> WaysOf(const Target& from, const Target& to) {
  const Matrix3 first = Rotation(from.X_PT), last = Rotation(to.X_PT);
  const Turning& turning = to.turning;
  std::vector<Way> ways;
  if (turning.swivel) ways.push_back(Swivelling(first, last, *turning.swivel));
  if (turning.angles && from.turning.angles)
    ways.emplace_back([&turning, begin = *from.turning.angles](Real share) {
      return turning.of_angles(begin + share * (*turning.angles - begin));
    });
  if (turning.even || ways.empty()) ways.push_back(Evenly(first, last));
  return ways;
}

Off FromSegment(const Place& place, const Place& from, const Place& to, const std::vector<Way>& ways) {
  const Vector3 begin = Tip(from.X), way = Tip(to.X) - begin, tip = Tip(place.X);
  const Real length = way.squaredNorm();
  const auto at = [&](Real share) -> Off {
    Off off{(tip - begin - share * way).norm(), 0, share, Between(from.external, to.external, share)};
    for (const Way& turned : ways)
      off.angle = std::max(off.angle, AngleBetween(Rotation(place.X), turned(share)));
    for (size_t i = 0; i < off.external.size(); ++i)
      off.external[i] = std::abs(off.external[i] - place.external[i]);
    return off;
  };
  if (length < 1e-18L) {
    const Off first = at(0), last = at(1);
    return first.Worst() < last.Worst() ? first : last;
  }
  return at(std::clamp(way.dot(tip - begin) / length, Real{0}, Real{1}));
}

/// From a motion of the program.
Off FromMotion(const Place& place, const Target& from, const Target& to) {
  return FromSegment(place, PlaceOf(from), PlaceOf(to), WaysOf(from, to));
}

/// From the planned way between two points: one even turn.
Off FromPlan(const Place& place, const Place& from, const Place& to) {
  return FromSegment(place, from, to, {Evenly(Rotation(from.X), Rotation(to.X))});
}

/// The middle of the planned way between two points.
Place Middle(const Place& from, const Place& to) {
  Place place{(from.X + to.X) / 2, Between(from.external, to.external, 0.5L)};
  place.X.block<3, 3>(0, 0) = Evenly(Rotation(from.X), Rotation(to.X))(0.5L);
  return place;
}

/// Collects the largest deviations and where they are.
class Worst {
 public:
  explicit Worst(const Setup& setup) : setup_(setup) {}
  void Add(const Off& off, const std::string& where) {
    for (size_t i = 0; i < off.external.size(); ++i) {
      const Real away = off.external[i] / (setup_.axes[i].rotary ? kDegree : 1);
      if (away <= deviation_.external) continue;
      deviation_.external = away;
      deviation_.external_where = setup_.axes[i].name + " at " + where;
    }
    deviation_.position = std::max(deviation_.position, off.position);
    deviation_.angle = std::max(deviation_.angle, off.angle);
    if (off.Worst() <= worst_) return;
    worst_ = off.Worst();
    deviation_.where = where;
  }
  const Deviation& deviation() const { return deviation_; }

 private:
  const Setup& setup_;
  Deviation deviation_;
  Real worst_ = -1;
};

std::string Name(const Row& row) {
  return "point " + std::to_string(row.point) + " of pass " + std::to_string(row.pass);
}
std::string Name(const Target& target) { return target.file + ":" + std::to_string(target.line); }

/// The first target from `begin` on that is at the pose; else the nearest of all.
size_t FindStart(const std::vector<Target>& targets, size_t begin, const Place& place) {
  size_t nearest = begin;
  Real best = std::numeric_limits<Real>::infinity();
  for (size_t j = begin; j < targets.size(); ++j) {
    const Real off = FromPlan(PlaceOf(targets[j]), place, place).Worst();
    if (off <= 1) return j;
    if (off < best) {
      best = off;
      nearest = j;
    }
  }
  return nearest;
}

/// Walks along one cut in program and table together; between two points, where the middle of their way is.
void CompareCut(const std::vector<Target>& targets, Cut& cut, const Setup& setup, size_t begin,
                Worst& worst) {
  std::vector<Place> poses;  // points and middles by turns
  for (size_t i = 0; i < cut.rows.size() + (cut.closed ? 1 : 0); ++i) {
    const Row& row = *cut.rows[i % cut.rows.size()];
    const Place place{ToolOnPart(setup, row.angles, row.external), row.external};
    if (i > 0) poses.push_back(Middle(poses.back(), place));
    poses.push_back(place);
  }

  cut.first = FindStart(targets, begin, poses[0]);
  worst.Add(FromPlan(poses[0], PlaceOf(targets[cut.first]), PlaceOf(targets[cut.first])), Name(*cut.rows[0]));
  size_t segment = cut.first;  // the program's motion from targets[segment] to the next
  Real share = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Real window = 3 * (Tip(poses[i].X) - Tip(poses[i - 1].X)).norm() + 1;
    Off best{1e9L, 1e9L, 0, {}};
    size_t found = segment;
    Real travelled = 0;
    for (size_t j = segment; j + 1 < targets.size() && (travelled <= window || j <= segment + 1); ++j) {
      const Off off = FromMotion(poses[i], targets[j], targets[j + 1]);
      // A later point must not be found before an earlier one.
      if (off.Worst() < best.Worst() && (j > segment || off.share >= share)) {
        best = off;
        found = j;
      }
      // Where the tool goes back the way that it came (a hole), the first motion that passes there is meant.
      if (best.Worst() <= 1) break;
      // Of the motion that the last point lies on, only what is left counts.
      travelled += (j == segment ? 1 - share : 1) * (Tip(targets[j + 1].X_PT) - Tip(targets[j].X_PT)).norm();
    }
    worst.Add(best, (i % 2 ? "half-way to " : "") + Name(*cut.rows[(i + 1) / 2 % cut.rows.size()]));
    for (size_t j = segment + 1; j <= found; ++j)
      worst.Add(FromPlan(PlaceOf(targets[j]), poses[i - 1], poses[i]), Name(targets[j]));
    segment = found;
    share = best.share;
  }
  cut.last = share > 0.5L ? std::min(segment + 1, targets.size() - 1) : segment;
}

}  // namespace

std::vector<Cut> CutsOf(const std::vector<Row>& rows, const Setup& setup) {
  std::vector<Cut> cuts;
  for (const Row& row : rows) {
    if (!row.planned) continue;
    const Row* last = cuts.empty() ? nullptr : cuts.back().rows.back();
    if (!last || last->pass != row.pass || last->piece != row.piece) cuts.emplace_back();
    cuts.back().rows.push_back(&row);
  }
  for (Cut& cut : cuts) {
    size_t of_pass = 0;
    for (const Row& row : rows) of_pass += row.pass == cut.rows[0]->pass;
    const Real opening = (cut.rows.back()->position - cut.rows.front()->position).norm();
    const bool moving =
        std::ranges::any_of(cut.rows, [&](const Row* row) { return row->external != cut.rows[0]->external; });
    const bool ring = setup.rings && !moving && cut.rows.size() == of_pass && of_pass > 3 &&
                      opening <= 1.01L * setup.spacing;
    cut.closed = ring || cut.rows[0]->closed;
  }
  return cuts;
}

Deviation Compare(const std::vector<Target>& targets, std::vector<Cut>& cuts, const Setup& setup) {
  Worst worst(setup);
  size_t begin = 0;
  for (Cut& cut : cuts) {
    if (begin >= targets.size()) {
      const std::string ends = "the program ends before " + Name(*cut.rows[0]);
      return {1e9L, 1e9L, ends, setup.axes.empty() ? 0 : 1e9L, ends};
    }
    CompareCut(targets, cut, setup, begin, worst);
    begin = cut.last + 1;
  }
  return worst.deviation();
}

namespace {

bool Same(const std::vector<Real>& a, const std::vector<Real>& b, const Setup& setup) {
  for (size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > kExternalBound * (setup.axes[i].rotary ? kDegree : 1)) return false;
  return true;
}

/// Between the same poses of the arm.
bool ArmStands(const Target& from, const Target& to) {
  constexpr Real kStill = 1e-5L * kDegree;
  if (!from.angles || !to.angles) return false;
  for (size_t i = 0; i < 6; ++i)
    if (std::abs((*from.angles)[i] - (*to.angles)[i]) > kStill) return false;
  return true;
}

}  // namespace

std::vector<std::string> ExternalViolations(const std::string& controller, const std::vector<Target>& targets,
                                            const std::vector<Cut>& cuts, const Setup& setup) {
  std::vector<std::string> violations;
  if (setup.axes.empty()) return violations;
  std::vector<Real> home;
  for (const ExternalAxis& axis : setup.axes) home.push_back(axis.home);
  const auto moves_uncounted = [&](const Target& from, const Target& to) {
    return std::ranges::any_of(setup.controller_axes.at(controller), [&](const ControllerAxis& axis) {
      return !axis.coupled && from.external[axis.axis] != to.external[axis.axis];
    });
  };
  size_t begin = 0;
  for (size_t c = 0; c <= cuts.size(); ++c) {
    const size_t end = c < cuts.size() ? cuts[c].first : targets.size() - 1;
    const std::vector<Real>&before = c > 0 ? cuts[c - 1].rows.back()->external : home,
          &after = c < cuts.size() ? cuts[c].rows.front()->external : home;
    for (size_t j = begin; j <= end; ++j) {
      const Target& target = targets[j];
      if (!Same(target.external, before, setup) && !Same(target.external, after, setup))
        violations.push_back(Name(target) + ": the external axes are at neither end of a way");
      if (j > begin && target.external != targets[j - 1].external && !ArmStands(targets[j - 1], target))
        violations.push_back(Name(target) + ": external axes move with the arm outside of a cut");
    }
    if (c == cuts.size()) break;
    for (size_t j = cuts[c].first + 1; j <= cuts[c].last; ++j)
      if (!targets[j].angles && moves_uncounted(targets[j - 1], targets[j]))
        violations.push_back(Name(targets[j]) + ": an axis moves along a line that does not count in it");
    begin = cuts[c].last;
  }
  return violations;
}

}  // namespace millpose::audit
