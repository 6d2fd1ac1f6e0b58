// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/decompositions.hpp"
#include "base/student.hpp"

namespace millpose {
namespace {

constexpr size_t kLeastReadings = 5;
constexpr double kSpread = 1.7;  // of published cutting forces, either way
constexpr double kLeastExplained = 0.5;
constexpr double kMicrometres = 1000;

/// Coefficients of a linear model with their variances; empty variances where it is not determined.
struct Fit {
  Eigen::VectorXd coefficients, variances;
  double residual = 0;  ///< standard deviation
  double explained = 0;
  double freedom = 0;
};

std::optional<Fit> Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  Fit fit;
  fit.freedom = static_cast<double>(A.rows() - A.cols());
  const std::optional<Eigen::VectorXd> solution = LeastSquaresOfFullRank(A, b);
  if (!solution || fit.freedom < 1) return std::nullopt;
  fit.coefficients = *solution;
  const double square = (b - A * fit.coefficients).squaredNorm();
  const double all = (b.array() - b.mean()).square().sum();
  fit.residual = std::sqrt(square / fit.freedom);
  fit.explained = all > 0 ? std::clamp(1 - square / all, 0.0, 1.0) : 0;
  fit.variances = (A.transpose() * A).inverse().diagonal() * (square / fit.freedom);
  return fit;
}

CalibratedFactor FactorOf(const Fit& fit, Eigen::Index at, size_t readings) {
  const double half = StudentQuantile(fit.freedom) * std::sqrt(std::max(0.0, fit.variances[at]));
  const double value = fit.coefficients[at];
  return {value, value - half, value + half, readings, value - half > 0};
}

/// Standard deviation of one reading about the mean of its place.
std::optional<double> Repeatability(const std::vector<FaceReading>& readings) {
  std::map<int, std::vector<double>> places;
  for (const FaceReading& reading : readings)
    if (reading.place >= 0) places[reading.place].push_back(reading.measured);
  double square = 0, freedom = 0;
  for (const auto& [place, values] : places) {
    double mean = 0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    for (const double value : values) square += (value - mean) * (value - mean);
    freedom += static_cast<double>(values.size()) - 1;
  }
  if (freedom == 0) return std::nullopt;
  return std::sqrt(square / freedom);
}

double RangeOf(const std::vector<FaceReading>& readings, double FaceReading::*member) {
  const auto [least, most] = std::ranges::minmax_element(readings, {}, member);
  return (*most).*member - (*least).*member;
}

void FitSides(const std::vector<FaceReading>& readings, const Eigen::VectorXd& b, Calibration& result) {
  constexpr size_t kLeastOfSide = 3;
  std::vector<size_t> sides;
  for (const FaceReading& reading : readings) ++result.sides[static_cast<size_t>(reading.side)].readings;
  for (size_t side = 0; side < result.sides.size(); ++side)
    if (result.sides[side].readings >= kLeastOfSide) sides.push_back(side);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(b.size(), static_cast<Eigen::Index>(sides.size()) + 1);
  A.col(0).setOnes();
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    const FaceReading& reading = readings[static_cast<size_t>(i)];
    const auto at = std::ranges::find(sides, static_cast<size_t>(reading.side));
    if (at != sides.end()) A(i, at - sides.begin() + 1) = reading.predicted;
  }
  const std::optional<Fit> fit = Solve(A, b);
  for (size_t k = 0; fit && k < sides.size(); ++k)
    result.sides[sides[k]] =
        FactorOf(*fit, static_cast<Eigen::Index>(k) + 1, result.sides[sides[k]].readings);
}

std::string VerdictOn(const Calibration& c) {
  if (c.readings < kLeastReadings)
    return fmt::format("{} readings say nothing about the model: at least {} are needed", c.readings,
                       kLeastReadings);
  const std::string ranges = fmt::format("measured it varies by {:.3g} µm, predicted by {:.3g} µm",
                                         kMicrometres * c.measured_range, kMicrometres * c.predicted_range);
  if (c.predicted_range == 0)
    return "the prediction is the same everywhere, so no scale can be determined: " + ranges;
  const std::string scale = fmt::format("{:.3g} times the predicted (95 %: {:.3g} to {:.3g})", c.scale.value,
                                        c.scale.low, c.scale.high);
  const std::string share = fmt::format("{:.0f} % of the measured variation", 100 * c.explained);
  if (c.usable())
    return fmt::format("the model explains the part: it accounts for {}, and the deflection is {}", share,
                       scale);
  if (c.explains_variation)
    return fmt::format(
        "the model explains where the part is high and low ({}), but not by how much: the deflection is {}, "
        "beyond what cutting forces are uncertain by (a factor of {})",
        share, scale, kSpread);
  return fmt::format(
      "the model explains neither the size nor the variation of what was measured: it accounts for {}, the "
      "scale would be {}; {}. What it leaves out (links, mounting, dynamics, a worn edge, the measurement) "
      "is "
      "larger than what it predicts: no factor is to be drawn from this",
      share, scale, ranges);
}

}  // namespace

Calibration Calibrate(const std::vector<FaceReading>& readings) {
  Calibration result;
  result.readings = readings.size();
  result.repeatability = Repeatability(readings);
  if (readings.size() >= kLeastReadings) {
    result.measured_range = RangeOf(readings, &FaceReading::measured);
    result.predicted_range = RangeOf(readings, &FaceReading::predicted);
    const auto rows = static_cast<Eigen::Index>(readings.size());
    Eigen::MatrixXd A(rows, 2);
    Eigen::VectorXd b(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const FaceReading& reading = readings[static_cast<size_t>(i)];
      A.row(i) << 1, reading.predicted;
      b[i] = reading.measured + reading.taken;
    }
    if (const std::optional<Fit> fit = Solve(A, b)) {
      result.offset = fit->coefficients[0];
      result.scale = FactorOf(*fit, 1, readings.size());
      result.explained = fit->explained;
      result.residual = fit->residual;
      result.explains_variation = result.scale.determined && result.explained >= kLeastExplained;
      result.explains_size =
          result.explains_variation && result.scale.value >= 1 / kSpread && result.scale.value <= kSpread;
      FitSides(readings, b, result);
    }
  }
  result.verdict = VerdictOn(result);
  return result;
}

}  // namespace millpose
