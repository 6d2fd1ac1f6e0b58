// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/resample.hpp"

#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

// mm: of what differs by less the first is taken, so that rounding far from the origin decides nothing.
constexpr double kFarTie = 1e-7;

struct DensePoint {
  CurvePoint at;
  Eigen::Vector3d position;
};

// Pieces' ends and, on arcs, points close enough that their chords deviate by an eighth of the tolerance at
// most.
std::vector<DensePoint> Flatten(const Curve& curve, double tolerance) {
  std::vector<DensePoint> dense{{{0, 0, 0}, curve.pieces.front().At(0)}};
  for (size_t i = 0; i < curve.pieces.size(); ++i) {
    const CurvePiece& piece = curve.pieces[i];
    int steps = 1;
    if (piece.arc) {
      // The sagitta of an angle δ of an ellipse is at most |half-axes|·δ²/8.
      const double size = std::sqrt(piece.u.squaredNorm() + piece.v.squaredNorm());
      const double step = std::sqrt(tolerance / size);
      steps = std::max(1, static_cast<int>(std::ceil(std::abs(piece.angle1 - piece.angle0) / step)));
    }
    for (int k = 1; k <= steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      const Eigen::Vector3d position = piece.At(t);
      const double length = dense.back().at.arc_length + (position - dense.back().position).norm();
      dense.push_back({{static_cast<int>(i), t, length}, position});
    }
  }
  return dense;
}

// Marks the points between first and last that are needed to stay within the tolerance.
void MarkCorners(const std::vector<DensePoint>& dense, size_t first, size_t last, double tolerance,
                 std::vector<char>& key) {
  std::vector<std::pair<size_t, size_t>> spans{{first, last}};
  while (!spans.empty()) {
    const auto [begin, end] = spans.back();
    spans.pop_back();
    const Eigen::Vector3d &a = dense[begin].position, &b = dense[end].position;
    double worst = tolerance;
    size_t corner = begin;
    for (size_t i = begin + 1; i < end; ++i) {
      const Eigen::Vector3d& p = dense[i].position;
      const double distance = (a + ClosestOnSegment(p, a, b) * (b - a) - p).norm();
      if (distance > worst + kFarTie) {
        worst = distance;
        corner = i;
      }
    }
    if (corner == begin) continue;
    key[corner] = 1;
    spans.emplace_back(begin, corner);
    spans.emplace_back(corner, end);
  }
}

// The point at a length along the dense points; `from` is where the search goes on.
CurvePoint AtLength(const std::vector<DensePoint>& dense, double length, size_t& from) {
  while (from + 2 < dense.size() && dense[from + 1].at.arc_length < length) ++from;
  const CurvePoint &a = dense[from].at, &b = dense[from + 1].at;
  const double share = (length - a.arc_length) / (b.arc_length - a.arc_length);
  const double t0 = a.piece == b.piece ? a.t : 0.0;  // a is the end of the piece before
  return {b.piece, t0 + share * (b.t - t0), length};
}

}  // namespace

std::vector<CurvePoint> Resample(const Curve& curve, double chord_tolerance, double spacing, int parts) {
  const std::vector<DensePoint> dense = Flatten(curve, chord_tolerance);
  const size_t last = dense.size() - 1;
  std::vector<char> key(dense.size(), 0);
  key[0] = key[last] = 1;
  if (curve.closed) {  // both halves need a chord of their own to be measured from
    size_t far = 0;
    for (size_t i = 0; i < dense.size(); ++i)
      if ((dense[i].position - dense[0].position).norm() >
          (dense[far].position - dense[0].position).norm() + kFarTie)
        far = i;
    key[far] = 1;
    MarkCorners(dense, 0, far, chord_tolerance / 2, key);
    MarkCorners(dense, far, last, chord_tolerance / 2, key);
  } else {
    MarkCorners(dense, 0, last, chord_tolerance / 2, key);
  }
  std::vector<CurvePoint> points{dense[0].at};
  size_t search = 0;
  for (size_t i = 1; i <= last; ++i) {
    if (key[i] == 0) continue;
    const double begin = points.back().arc_length, length = dense[i].at.arc_length - begin;
    const int steps = parts * std::max(1, static_cast<int>(std::ceil(length / spacing - 1e-9)));
    for (int k = 1; k < steps; ++k) points.push_back(AtLength(dense, begin + length * k / steps, search));
    if (i < last || !curve.closed) points.push_back(dense[i].at);
  }
  return points;
}

}  // namespace millpose
