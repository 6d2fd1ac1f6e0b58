// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/error_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "base/student.hpp"
#include "base/trig.hpp"

namespace millpose {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr size_t kMostPlaces = 250;
constexpr double kSamePlace = 0.01;  // mm

/// Matérn's covariance of order 5/2.
double Matern(double distance, double length) {
  constexpr double kRoot5 = 2.23606797749979;
  const double r = kRoot5 * distance / length;
  return r > 600 ? 0 : (1 + r + r * r / 3) * Exp(-r);
}

/// Inverse of a symmetric positive definite matrix by its own Cholesky factor: Eigen's blocks follow the
/// processor's caches, and with them the last bits.
MatrixXd InverseOf(MatrixXd a) {
  const Eigen::Index n = a.rows();
  for (Eigen::Index j = 0; j < n; ++j) {  // L into the lower triangle, by columns
    a(j, j) = std::sqrt(std::max(a(j, j), 1e-14));
    for (Eigen::Index i = j + 1; i < n; ++i) a(i, j) /= a(j, j);
    for (Eigen::Index k = j + 1; k < n; ++k)
      for (Eigen::Index i = k; i < n; ++i) a(i, k) -= a(i, j) * a(k, j);
  }
  MatrixXd back = MatrixXd::Zero(n, n);  // L⁻¹, lower
  for (Eigen::Index c = 0; c < n; ++c) {
    back(c, c) = 1;
    for (Eigen::Index k = c; k < n; ++k) {
      back(k, c) /= a(k, k);
      for (Eigen::Index i = k + 1; i < n; ++i) back(i, c) -= a(i, k) * back(k, c);
    }
  }
  MatrixXd inverse(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      double sum = 0;
      for (Eigen::Index k = i; k < n; ++k) sum += back(k, i) * back(k, j);
      inverse(i, j) = inverse(j, i) = sum;
    }
  return inverse;
}

VectorXd Times(const MatrixXd& a, const VectorXd& x) {
  VectorXd y = VectorXd::Zero(a.rows());
  for (Eigen::Index j = 0; j < a.cols(); ++j)
    for (Eigen::Index i = 0; i < a.rows(); ++i) y[i] += a(i, j) * x[j];
  return y;
}

double Dot(const VectorXd& a, const VectorXd& b) {
  double sum = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Of two places ÷ s².
double Covariance(const MilledPlace& a, const MilledPlace& b, const ErrorField::Shape& shape) {
  double product = 0;
  for (int gear = 0; gear < kMostGears; ++gear) product += a.flanks[gear] * b.flanks[gear];
  return 1 + Matern((a.position - b.position).norm(), shape.length) + shape.by_flanks * product;
}

/// Of the places' values ÷ s².
MatrixXd CovarianceOf(const std::vector<MilledPlace>& places, const VectorXd& counts,
                      const ErrorField::Shape& shape) {
  const auto n = static_cast<Eigen::Index>(places.size());
  MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j)
      covariance(i, j) = covariance(j, i) =
          Covariance(places[static_cast<size_t>(i)], places[static_cast<size_t>(j)], shape);
    covariance(i, i) += shape.noise_ratio / counts[i];
  }
  return covariance;
}

/// Readings as places with means.
struct Places {
  std::vector<MilledPlace> at;
  VectorXd value, count;
  double repeat_squares = 0;  ///< of the readings of one place about their mean
  int repeat_freedom = 0;
};

double HalfSize(const std::vector<ErrorReading>& readings) {
  Vector3d low = readings.front().place.position, high = low;
  for (const ErrorReading& reading : readings)
    low = low.cwiseMin(reading.place.position), high = high.cwiseMax(reading.place.position);
  return std::max(1e-3, 0.5 * (high - low).norm());
}

/// 1 ÷ the mean square of the flanks' length, rad²/mm²; 0 where none is known.
double FlankScale(const std::vector<ErrorReading>& readings) {
  double squares = 0;
  for (const ErrorReading& reading : readings)
    for (int gear = 0; gear < kMostGears; ++gear)
      squares += reading.place.flanks[gear] * reading.place.flanks[gear];
  return squares > 0 ? static_cast<double>(readings.size()) / squares : 0;
}

/// Centres such that every reading is near to one: each new one is the reading farthest from those before,
/// until it is nearer than `kSamePlace` or there are `kMostPlaces`. Places passed on other flanks are far.
std::vector<size_t> OwnerOf(const std::vector<ErrorReading>& readings) {
  const double apart_by_flanks = HalfSize(readings) * std::sqrt(FlankScale(readings));
  const auto apart = [&](const MilledPlace& a, const MilledPlace& b) {
    return (a.position - b.position).norm() + apart_by_flanks * (a.flanks - b.flanks).norm();
  };
  std::vector<size_t> owner(readings.size(), 0);
  std::vector<double> distance(readings.size(), std::numeric_limits<double>::infinity());
  size_t next = 0;
  for (size_t centre = 0; centre < kMostPlaces; ++centre) {
    for (size_t i = 0; i < readings.size(); ++i)
      if (const double d = apart(readings[i].place, readings[next].place); d < distance[i])
        distance[i] = d, owner[i] = centre;
    next = static_cast<size_t>(std::ranges::max_element(distance) - distance.begin());
    if (distance[next] < kSamePlace) break;
  }
  return owner;
}

Places PlacesOf(const std::vector<ErrorReading>& readings) {
  const std::vector<size_t> owner = OwnerOf(readings);
  const size_t n = std::ranges::max(owner) + 1;
  Places places;
  places.at.resize(n);
  places.value = places.count = VectorXd::Zero(static_cast<Eigen::Index>(n));
  for (size_t i = 0; i < readings.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(owner[i]);
    places.at[owner[i]].position += readings[i].place.position;
    places.at[owner[i]].flanks += readings[i].place.flanks;
    places.value[k] += readings[i].error;
    places.count[k] += 1;
  }
  for (size_t k = 0; k < n; ++k) {
    places.at[k].position /= places.count[static_cast<Eigen::Index>(k)];
    places.at[k].flanks /= places.count[static_cast<Eigen::Index>(k)];
  }
  for (Eigen::Index k = 0; k < places.value.size(); ++k) places.value[k] /= places.count[k];
  std::vector<double> spread(n, 0);
  std::vector<char> same(n, 1);
  for (size_t i = 0; i < readings.size(); ++i) {
    const double off = readings[i].error - places.value[static_cast<Eigen::Index>(owner[i])];
    spread[owner[i]] += off * off;
    if ((readings[i].place.position - places.at[owner[i]].position).norm() > kSamePlace) same[owner[i]] = 0;
  }
  for (size_t k = 0; k < n; ++k)
    if (const auto more = static_cast<int>(places.count[static_cast<Eigen::Index>(k)]) - 1;
        same[k] != 0 && more > 0)
      places.repeat_squares += spread[k], places.repeat_freedom += more;
  return places;
}

/// Σ count·(what is foretold of each place by the others − its value)²: [K⁻¹y]ᵢ ÷ [K⁻¹]ᵢᵢ is the difference.
double LeftOut(const MatrixXd& inverse, const VectorXd& value, const VectorXd& count) {
  const VectorXd weights = Times(inverse, value);
  double sum = 0;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    const double off = weights[i] / inverse(i, i);
    sum += count[i] * off * off;
  }
  return sum;
}

}  // namespace

ErrorField::ErrorField(std::vector<MilledPlace> places, const VectorXd& values, const VectorXd& counts,
                       const Shape& shape)
    : places_(std::move(places)), shape_(shape) {
  inverse_ = InverseOf(CovarianceOf(places_, counts, shape));
  weights_ = Times(inverse_, values);
  scale_ = std::sqrt(std::max(0.0, Dot(values, weights_) / static_cast<double>(places_.size())));
  noise_ = scale_ * std::sqrt(shape.noise_ratio);
}

VectorXd ErrorField::Covariances(const MilledPlace& place) const {
  VectorXd k(static_cast<Eigen::Index>(places_.size()));
  for (size_t i = 0; i < places_.size(); ++i)
    k[static_cast<Eigen::Index>(i)] = Covariance(places_[i], place, shape_);
  return k;
}

double ErrorField::At(const MilledPlace& place) const {
  return places_.empty() ? 0 : Dot(Covariances(place), weights_);
}

double ErrorField::DeviationAt(const MilledPlace& place) const {
  if (places_.empty()) return 0;
  const VectorXd k = Covariances(place);
  return scale_ * std::sqrt(std::max(0.0, Covariance(place, place, shape_) - Dot(k, Times(inverse_, k))));
}

FittedErrors FitErrors(const std::vector<ErrorReading>& readings) {
  constexpr size_t kLeastReadings = 6;
  constexpr int kDrawn = 99;
  constexpr std::array<double, 4> kLengths = {0.125, 0.25, 0.5, 1};  // of the half size
  constexpr int kLevels = 8;
  FittedErrors fitted;
  fitted.readings = readings.size();
  if (readings.empty()) return fitted;
  const Places places = PlacesOf(readings);
  fitted.places = places.at.size();
  if (places.repeat_freedom > 0)
    fitted.repeatability = std::sqrt(places.repeat_squares / places.repeat_freedom);
  double all = 0;  // Σ count·value²
  for (Eigen::Index i = 0; i < places.value.size(); ++i)
    all += places.count[i] * places.value[i] * places.value[i];
  const auto total = static_cast<double>(readings.size());
  fitted.size = std::sqrt(all / total);
  if (readings.size() < kLeastReadings || places.at.size() < kLeastReadings || !(all > 0)) return fitted;

  // The same with signs drawn at random: what a fit makes of errors that no place tells from its neighbours.
  std::vector<VectorXd> drawn(kDrawn, places.value);
  RandomStream random(1, 0);
  for (VectorXd& values : drawn)
    for (double& value : values) value = random.Below(2) == 0 ? value : -value;
  std::vector<double> least_drawn(kDrawn, std::numeric_limits<double>::infinity());
  double least = std::numeric_limits<double>::infinity();
  ErrorField::Shape best;
  const double half = HalfSize(readings), by_flanks = FlankScale(readings);
  for (int choice = 0; choice < 2 * kLevels * static_cast<int>(kLengths.size()); ++choice) {
    ErrorField::Shape shape;
    shape.by_flanks = choice % 2 * by_flanks;
    shape.length = kLengths[static_cast<size_t>(choice / 2 / kLevels)] * half;
    shape.noise_ratio = 1e-4;
    for (int level = choice / 2 % kLevels; level > 0; --level) shape.noise_ratio *= 6;
    const MatrixXd inverse = InverseOf(CovarianceOf(places.at, places.count, shape));
    if (const double off = LeftOut(inverse, places.value, places.count); off < least)
      least = off, best = shape;
    for (size_t d = 0; d < drawn.size(); ++d)
      least_drawn[d] = std::min(least_drawn[d], LeftOut(inverse, drawn[d], places.count));
  }
  fitted.field = ErrorField(places.at, places.value, places.count, best);
  fitted.left = std::sqrt(least / total);
  fitted.explained = std::max(0.0, 1 - least / all);
  fitted.significant =
      least < all && std::ranges::all_of(least_drawn, [&](double other) { return least < other; });
  return fitted;
}

Repeats RepeatsOf(const ErrorField& field, const std::vector<ErrorReading>& other) {
  double ff = 0, fe = 0, ee = 0;
  for (const ErrorReading& reading : other) {
    const double f = field.At(reading.place);
    ff += f * f, fe += f * reading.error, ee += reading.error * reading.error;
  }
  Repeats repeats;
  const double freedom = static_cast<double>(other.size()) - 1;
  if (freedom < 3 || !(ff > 0)) return repeats;
  repeats.share = fe / ff;
  const double squares = std::max(0.0, ee - repeats.share * fe);
  repeats.left = std::sqrt(squares / static_cast<double>(other.size()));
  const double reach = StudentQuantile(freedom) * std::sqrt(squares / freedom / ff);
  repeats.low = repeats.share - reach;
  repeats.high = repeats.share + reach;
  return repeats;
}

}  // namespace millpose
