// SPDX-License-Identifier: GPL-3.0-or-later
// What the generators of tool path files share.
#pragma once

#include "base/random.hpp"
#include "tests/toolpath/path_check.hpp"

namespace millpose {

/// A file and what it means.
struct GeneratedPath {
  std::string text;
  std::vector<Want> wants;
  size_t holes_left_out = 0;
};

/// Files per generator: 1,500, or as many as MILLPOSE_PATHS says.
uint64_t GeneratedCount();

/// Random numbers as a writer needs them.
class WriterRandom {
 public:
  WriterRandom(uint64_t seed, uint64_t index) : random_(seed, index) {}
  bool Chance(double share) { return random_.Uniform() < share; }
  double Between(double low, double high) { return random_.Uniform(low, high); }
  size_t Below(size_t count) { return static_cast<size_t>(random_.Below(static_cast<int>(count))); }
  /// Each coordinate within ±size.
  Eigen::Vector3d Vector(double size) {
    return {Between(-size, size), Between(-size, size), Between(-size, size)};
  }
  RandomStream& stream() { return random_; }

 private:
  RandomStream random_;
};

/// The number that nine decimals print.
double Printed(double value);
Eigen::Vector3d Printed(const Eigen::Vector3d& v);

/// Reads the file and compares to 1e-6 mm.
void ExpectRead(const GeneratedPath& path, const CamReadOptions& options, uint64_t index);

/// Puts `line` somewhere between the file's lines: it must be refused, with its name or place.
void ExpectUnknownRefused(const std::string& text, const std::string& line, const CamReadOptions& options,
                          RandomStream& random);

/// Five random letters that begin with Z, X or Q: no word of any format.
std::string RandomWord(RandomStream& random);

/// A rational B-spline at 2^9 even places of each span, by the recursion of the basis functions.
std::vector<Eigen::Vector3d> DenseSpline(const std::vector<Eigen::Vector3d>& control,
                                         const std::vector<double>& weights, const std::vector<double>& knots,
                                         size_t degree);

}  // namespace millpose
