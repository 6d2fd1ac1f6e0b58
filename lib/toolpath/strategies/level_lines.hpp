// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <stop_token>
#include <unordered_map>

#include "geometry/slice/curve.hpp"
#include "toolpath/region.hpp"

namespace millpose {

/// A function on the surface, mm, that changes by about 1 mm per mm at most.
struct LevelField {
  std::function<double(int face, const Eigen::Vector3d& p)> value;
  /// Values that differ by it are the same level (a spiral's turns); infinite for an ordinary function.
  double period = std::numeric_limits<double>::infinity();
  /// Of a periodic function, where it may change faster than by 1 mm per mm: what it winds on by, without the
  /// seam. Edges are then halved until it changes by a quarter of the period at most.
  std::function<double(const Eigen::Vector3d& p)> winding;
};

/// Lines on a region's faces along which a function has a given value. The faces are halved along their edges
/// (from both sides alike, so there are no cracks) until no edge is longer than `longest` (mm); lines march
/// through these triangles, crossings are found on the edges by bisection of the function itself.
class LevelLines {
 public:
  /// `tolerance` (mm): how far lines may lie from the level between their points. Throws InputError when
  /// `longest` asks for too many triangles; Interrupted.
  LevelLines(const Region& region, LevelField field, double longest, double tolerance, std::stop_token stop);

  double largest() const { return largest_; }  ///< value at any vertex; -∞ without faces

  /// The lines of one level, open ones first, with the higher values on their left seen against the surface
  /// normal. Near the level edges are halved further where the function bends, so that corners of the line
  /// are not cut off.
  std::vector<Curve> At(double level, std::stop_token stop);

 private:
  struct Triangle {
    std::array<int, 3> corners;
    int face;
  };
  using EdgeMap = std::unordered_map<uint64_t, int>;  // looked up only, never walked through

  double Relative(double value, double level) const;
  int AddVertex(const Eigen::Vector3d& p, int face);
  bool Bends(int a, int b, const Eigen::Vector3d& middle, int face, double level) const;
  bool Winds(int a, int b, const Eigen::Vector3d& middle) const;
  int Middle(const Triangle& triangle, int k, const double* level, EdgeMap& middles);
  bool Split(const Triangle& triangle, const double* level, EdgeMap& middles, std::vector<Triangle>& halves);
  [[noreturn]] void Refuse() const;
  void Halve(const double* level, const std::stop_token& stop);

  const Region& region_;
  LevelField field_;
  double longest_, tolerance_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<double> values_;  // by vertex
  std::vector<Triangle> triangles_;
  double largest_ = -std::numeric_limits<double>::infinity();
};

}  // namespace millpose
