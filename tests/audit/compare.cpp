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

Off FromSegment(const Matrix4& X, const Matrix4& from, const Matrix4& to) {
  const Vector3 way = Tip(to) - Tip(from);
  const Real length = way.squaredNorm();
  const auto at = [&](Real share) -> Off {
    const Quaternion turned = Quaternion(Rotation(from)).slerp(share, Quaternion(Rotation(to)));
    return {(Tip(X) - Tip(from) - share * way).norm(),
            AngleBetween(Rotation(X), Matrix3(turned.toRotationMatrix())), share};
  };
  if (length < 1e-18L) {
    const Off first = at(0), last = at(1);
    return first.Worst() < last.Worst() ? first : last;
  }
  return at(std::clamp(way.dot(Tip(X) - Tip(from)) / length, Real{0}, Real{1}));
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
    const Real off = FromSegment(targets[j].X_WT, X, X).Worst();
    if (off <= 1) return j;
    if (off < best) {
      best = off;
      nearest = j;
    }
  }
  return nearest;
}

/// Walks along one cut in program and table together.
void CompareCut(const std::vector<Target>& targets, Cut& cut, const Setup& setup, size_t begin,
                Worst& worst) {
  std::vector<Matrix4> poses;
  for (const Row* row : cut.rows) poses.push_back(Tool(setup, row->angles));
  if (cut.closed) poses.push_back(poses.front());

  cut.first = FindStart(targets, begin, poses[0]);
  worst.Add(FromSegment(poses[0], targets[cut.first].X_WT, targets[cut.first].X_WT), Name(*cut.rows[0]));
  size_t segment = cut.first;  // the program's motion from targets[segment] to the next
  Real share = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Real window = 3 * (Tip(poses[i]) - Tip(poses[i - 1])).norm() + 1;
    Off best{1e9L, 1e9L, 0};
    size_t found = segment;
    Real travelled = 0;
    for (size_t j = segment; j + 1 < targets.size() && (travelled <= window || j <= segment + 1); ++j) {
      const Off off = FromSegment(poses[i], targets[j].X_WT, targets[j + 1].X_WT);
      // A later point must not be found before an earlier one.
      if (off.Worst() < best.Worst() && (j > segment || off.share >= share)) {
        best = off;
        found = j;
      }
      // Of the motion that the last point lies on, only what is left counts.
      travelled += (j == segment ? 1 - share : 1) * (Tip(targets[j + 1].X_WT) - Tip(targets[j].X_WT)).norm();
    }
    worst.Add(best, Name(*cut.rows[i % cut.rows.size()]));
    for (size_t j = segment + 1; j <= found; ++j)
      worst.Add(FromSegment(targets[j].X_WT, poses[i - 1], poses[i]), Name(targets[j]));
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
