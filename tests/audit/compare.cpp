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

/// How far a pose is from a straight motion of the tool.
struct Off {
  Real position, angle;
  Real share;  ///< of the way, where it is nearest
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
  const Matrix3 first = Rotation(from.X_WT), last = Rotation(to.X_WT);
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

Off FromSegment(const Matrix4& X, const Vector3& from, const Vector3& to, const std::vector<Way>& ways) {
  const Vector3 way = to - from;
  const Real length = way.squaredNorm();
  const auto at = [&](Real share) -> Off {
    Off off{(Tip(X) - from - share * way).norm(), 0, share};
    for (const Way& turned : ways) off.angle = std::max(off.angle, AngleBetween(Rotation(X), turned(share)));
    return off;
  };
  if (length < 1e-18L) {
    const Off first = at(0), last = at(1);
    return first.Worst() < last.Worst() ? first : last;
  }
  return at(std::clamp(way.dot(Tip(X) - from) / length, Real{0}, Real{1}));
}

/// From a motion of the program.
Off FromMotion(const Matrix4& X, const Target& from, const Target& to) {
  return FromSegment(X, Tip(from.X_WT), Tip(to.X_WT), WaysOf(from, to));
}

/// From the planned way between two points: one even turn.
Off FromPlan(const Matrix4& X, const Matrix4& from, const Matrix4& to) {
  return FromSegment(X, Tip(from), Tip(to), {Evenly(Rotation(from), Rotation(to))});
}

/// The middle of the planned way between two points.
Matrix4 Middle(const Matrix4& from, const Matrix4& to) {
  Matrix4 X = (from + to) / 2;
  X.block<3, 3>(0, 0) = Evenly(Rotation(from), Rotation(to))(0.5L);
  return X;
}

/// Collects the largest deviations and where they are.
class Worst {
 public:
  void Add(const Off& off, const std::string& where) {
    deviation_.position = std::max(deviation_.position, off.position);
    deviation_.angle = std::max(deviation_.angle, off.angle);
    if (off.Worst() <= worst_) return;
    worst_ = off.Worst();
    deviation_.where = where;
  }
  const Deviation& deviation() const { return deviation_; }

 private:
  Deviation deviation_;
  Real worst_ = -1;
};

std::string Name(const Row& row) {
  return "point " + std::to_string(row.point) + " of pass " + std::to_string(row.pass);
}
std::string Name(const Target& target) { return target.file + ":" + std::to_string(target.line); }

/// The first target from `begin` on that is at the pose; else the nearest of all.
size_t FindStart(const std::vector<Target>& targets, size_t begin, const Matrix4& X) {
  size_t nearest = begin;
  Real best = std::numeric_limits<Real>::infinity();
  for (size_t j = begin; j < targets.size(); ++j) {
    const Real off = FromPlan(targets[j].X_WT, X, X).Worst();
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
  std::vector<Matrix4> poses;  // points and middles by turns
  for (size_t i = 0; i < cut.rows.size() + (cut.closed ? 1 : 0); ++i) {
    const Matrix4 X = Tool(setup, cut.rows[i % cut.rows.size()]->angles);
    if (i > 0) poses.push_back(Middle(poses.back(), X));
    poses.push_back(X);
  }

  cut.first = FindStart(targets, begin, poses[0]);
  worst.Add(FromPlan(poses[0], targets[cut.first].X_WT, targets[cut.first].X_WT), Name(*cut.rows[0]));
  size_t segment = cut.first;  // the program's motion from targets[segment] to the next
  Real share = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Real window = 3 * (Tip(poses[i]) - Tip(poses[i - 1])).norm() + 1;
    Off best{1e9L, 1e9L, 0};
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
      travelled += (j == segment ? 1 - share : 1) * (Tip(targets[j + 1].X_WT) - Tip(targets[j].X_WT)).norm();
    }
    worst.Add(best, (i % 2 ? "half-way to " : "") + Name(*cut.rows[(i + 1) / 2 % cut.rows.size()]));
    for (size_t j = segment + 1; j <= found; ++j)
      worst.Add(FromPlan(targets[j].X_WT, poses[i - 1], poses[i]), Name(targets[j]));
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
    cut.closed = setup.rings && cut.rows.size() == of_pass && of_pass > 3 && opening <= 1.01L * setup.spacing;
  }
  return cuts;
}

Deviation Compare(const std::vector<Target>& targets, std::vector<Cut>& cuts, const Setup& setup) {
  Worst worst;
  size_t begin = 0;
  for (Cut& cut : cuts) {
    if (begin >= targets.size()) return {1e9L, 1e9L, "the program ends before " + Name(*cut.rows[0])};
    CompareCut(targets, cut, setup, begin, worst);
    begin = cut.last + 1;
  }
  return worst.deviation();
}

}  // namespace millpose::audit
