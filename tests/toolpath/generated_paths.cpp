// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/toolpath/generated_paths.hpp"

#include <cstdlib>

#include "base/error.hpp"

namespace millpose {
namespace {

double Basis(const std::vector<double>& t, size_t i, size_t degree, double u, size_t span) {
  if (degree == 0) return i == span ? 1 : 0;
  const auto part = [&](double over, double under) { return under > 0 ? over / under : 0.0; };
  return part(u - t[i], t[i + degree] - t[i]) * Basis(t, i, degree - 1, u, span) +
         part(t[i + degree + 1] - u, t[i + degree + 1] - t[i + 1]) * Basis(t, i + 1, degree - 1, u, span);
}

}  // namespace

uint64_t GeneratedCount() {
  const char* wanted = std::getenv("MILLPOSE_PATHS");
  return wanted != nullptr ? std::stoull(wanted) : 1500;
}

double Printed(double value) { return std::stod(fmt::format("{:.9f}", value)); }
Eigen::Vector3d Printed(const Eigen::Vector3d& v) { return {Printed(v.x()), Printed(v.y()), Printed(v.z())}; }

void ExpectRead(const GeneratedPath& path, const CamReadOptions& options, uint64_t index) {
  try {
    const CamPath read = ReadCamPath(path.text, "generated", options);
    EXPECT_EQ(Difference(read, path.wants, 1e-6, options.chord_tolerance), "") << "file " << index << "\n"
                                                                               << path.text;
    EXPECT_EQ(read.holes_left_out.size(), path.holes_left_out) << "file " << index << "\n" << path.text;
  } catch (const InputError& error) {
    ADD_FAILURE() << "file " << index << ": " << error.what() << "\n" << path.text;
  }
}

void ExpectUnknownRefused(const std::string& text, const std::string& line, const CamReadOptions& options,
                          RandomStream& random) {
  size_t at = text.find('\n', static_cast<size_t>(random.Below(static_cast<int>(text.size() / 2))));
  at = at == std::string::npos ? text.find('\n') : at;
  // Behind a line that ends its statement.
  while (at != std::string::npos && at + 1 < text.size() && at > 0 && text[at - 1] == '$')
    at = text.find('\n', at + 1);
  std::string spoilt = text;
  spoilt.insert(at + 1, line + "\n");
  try {
    ReadCamPath(spoilt, "spoilt", options);
    ADD_FAILURE() << "\"" << line << "\" is read\n" << spoilt;
  } catch (const InputError& error) {
    const size_t number =
        static_cast<size_t>(std::count(spoilt.begin(), spoilt.begin() + static_cast<long>(at) + 1, '\n')) + 1;
    EXPECT_NE(std::string(error.what()).find(fmt::format("spoilt:{}:", number)), std::string::npos)
        << error.what() << "\n"
        << spoilt;
  }
}

std::string RandomWord(RandomStream& random) {
  std::string word(1, "ZXQ"[random.Below(3)]);
  for (int i = 0; i < 4; ++i) word += static_cast<char>('A' + random.Below(26));
  return word;
}

std::vector<Eigen::Vector3d> DenseSpline(const std::vector<Eigen::Vector3d>& control,
                                         const std::vector<double>& weights, const std::vector<double>& knots,
                                         size_t degree) {
  constexpr int kEach = 1 << 9;
  std::vector<Eigen::Vector3d> points;
  for (size_t span = degree; span < control.size(); ++span) {
    if (!(knots[span + 1] > knots[span])) continue;
    for (int k = 0; k <= kEach; ++k) {
      const double u = knots[span] + (knots[span + 1] - knots[span]) * k / kEach;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double total = 0;
      for (size_t i = span - degree; i <= span; ++i) {
        const double b = Basis(knots, i, degree, u, span) * weights[i];
        sum += b * control[i];
        total += b;
      }
      points.emplace_back(sum / total);
    }
  }
  return points;
}

}  // namespace millpose
