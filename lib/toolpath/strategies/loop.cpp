// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/loop.hpp"

#include "geometry/mesh/triangle.hpp"

namespace millpose {

Loop::Loop(Curve curve) : curve_(std::move(curve)) {
  for (const CurvePiece& piece : curve_.pieces) begins_.push_back(begins_.back() + piece.LengthBound(0, 1));
}

std::pair<double, double> Loop::Nearest(const Eigen::Vector3d& p) const {
  std::pair<double, double> nearest{std::numeric_limits<double>::infinity(), 0};
  for (size_t i = 0; i < curve_.pieces.size(); ++i) {
    const CurvePiece& piece = curve_.pieces[i];
    const double t = ClosestOnSegment(p, piece.start, piece.end);
    const double distance = (piece.At(t) - p).norm();
    if (distance < nearest.first - 1e-7) nearest = {distance, begins_[i] + t * (begins_[i + 1] - begins_[i])};
  }
  return nearest;
}

void Loop::AppendPart(double from, double to, std::vector<CurvePiece>& way) const {
  for (size_t i = 0; i < curve_.pieces.size(); ++i) {
    const double begin = begins_[i], own = begins_[i + 1] - begin;
    const double t0 = std::max(0.0, (from - begin) / own), t1 = std::min(1.0, (to - begin) / own);
    if (t1 > t0 + 1e-12) way.push_back(curve_.pieces[i].Part(t0, t1));
  }
}

std::vector<CurvePiece> Loop::Way(double from, double ahead) const {
  std::vector<CurvePiece> way;
  from = std::fmod(from, length());
  AppendPart(from, std::min(from + ahead, length()), way);
  if (from + ahead > length()) AppendPart(0, from + ahead - length(), way);
  return way;
}

Eigen::Vector3d Loop::At(double at) const {
  size_t i = 0;
  while (i + 1 < curve_.pieces.size() && begins_[i + 1] < at) ++i;
  return curve_.pieces[i].At(std::clamp((at - begins_[i]) / (begins_[i + 1] - begins_[i]), 0.0, 1.0));
}

void Append(Curve& curve, const std::vector<CurvePiece>& pieces) {
  if (pieces.empty()) return;
  if (!curve.pieces.empty()) {
    const Eigen::Vector3d &end = curve.pieces.back().end, &start = pieces.front().start;
    if ((start - end).norm() > 1e-9) curve.pieces.push_back(LinePiece(pieces.front().face, end, start));
  }
  curve.pieces.insert(curve.pieces.end(), pieces.begin(), pieces.end());
}

}  // namespace millpose
