// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/track.hpp"

#include "base/trig.hpp"

namespace millpose {
namespace {

// The intervals of a piece that lie in the region, ascending. The margin is 1-Lipschitz: while both ends are
// farther inside (or outside) than the way between them is long, there is nothing to find between them.
class Clipper {
 public:
  Clipper(const CurvePiece& piece, const Region& region) : piece_(piece), region_(region) {}

  std::vector<std::pair<double, double>> Inside() {
    const double first = region_.Margin(piece_.face, piece_.At(0));
    inside_ = IsInside(first);
    if (inside_) begin_ = 0;
    Search(0, first, 1, region_.Margin(piece_.face, piece_.At(1)));
    if (inside_) intervals_.emplace_back(begin_, 1.0);
    std::erase_if(intervals_, [](const auto& interval) { return interval.second <= interval.first; });
    return intervals_;
  }

 private:
  static bool IsInside(double margin) { return margin >= -1e-9; }  // a curve may run along a border

  void Search(double t0, double m0, double t1, double m1) {
    constexpr double kAccuracy = 1e-7;  // mm, of a crossing
    constexpr double kBlind = 0.01;     // mm: the border may be crossed twice within less (and by half of it)
    const double length = piece_.LengthBound(t0, t1);
    if (IsInside(m0) == IsInside(m1) && (length <= kBlind || std::abs(m0) + std::abs(m1) > length)) return;
    if (length <= kAccuracy) {
      Toggle(inside_ ? t0 : t1);  // stay on the inner side
      return;
    }
    const double middle = (t0 + t1) / 2, margin = region_.Margin(piece_.face, piece_.At(middle));
    Search(t0, m0, middle, margin);
    Search(middle, margin, t1, m1);
  }

  void Toggle(double t) {
    if (inside_) intervals_.emplace_back(begin_, t);
    begin_ = t;
    inside_ = !inside_;
  }

  const CurvePiece& piece_;
  const Region& region_;
  bool inside_ = false;
  double begin_ = 0;
  std::vector<std::pair<double, double>> intervals_;
};

double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return Atan2(a.cross(b).norm(), a.dot(b));
}

double LengthBound(const Curve& curve) {
  double length = 0;
  for (const CurvePiece& piece : curve.pieces) length += piece.LengthBound(0, 1);
  return length;
}

}  // namespace

Eigen::Vector3d NormalOn(const Mesh& mesh, const CornerNormals& normals, const CurvePiece& piece,
                         const Eigen::Vector3d& p) {
  return normals.At(piece.face, mesh.ClosestOnFace(p, piece.face).barycentric);
}

std::vector<Curve> ClipToRegion(const Mesh& mesh, const Curve& curve, const Region& region,
                                const CornerNormals& normals, double crease, double least_length) {
  const auto continues = [&](const CurvePiece& before, const CurvePiece& after) {
    return Angle(NormalOn(mesh, normals, before, before.end), NormalOn(mesh, normals, after, after.start)) <=
           crease;
  };
  std::vector<Curve> parts;
  bool from_start = false,
       goes_on = false;  // the first part begins with the curve; the last may be continued
  for (size_t i = 0; i < curve.pieces.size(); ++i) {
    CurvePiece piece = curve.pieces[i];
    if (!region.HasFace(piece.face) && piece.other_face >= 0) std::swap(piece.face, piece.other_face);
    if (!region.HasFace(piece.face)) {
      goes_on = false;
      continue;
    }
    const auto intervals = Clipper(piece, region).Inside();
    if (intervals.empty()) goes_on = false;
    for (const auto& [t0, t1] : intervals) {
      const CurvePiece part = piece.Part(t0, t1);
      if (i == 0 && t0 == 0) from_start = true;
      if (!goes_on || t0 > 0 || !continues(parts.back().pieces.back(), part)) parts.emplace_back();
      parts.back().pieces.push_back(part);
      goes_on = t1 == 1;
    }
  }
  if (curve.closed && from_start && goes_on &&
      continues(parts.back().pieces.back(), parts.front().pieces.front())) {
    if (parts.size() == 1) {
      parts.front().closed = true;
    } else {  // the last part runs over the start into the first
      auto& last = parts.back().pieces;
      last.insert(last.end(), parts.front().pieces.begin(), parts.front().pieces.end());
      parts.erase(parts.begin());
    }
  }
  std::erase_if(parts, [&](const Curve& part) { return LengthBound(part) <= least_length; });
  return parts;
}

}  // namespace millpose
