// SPDX-License-Identifier: GPL-3.0-or-later
// The smooth part of a milled face's measured error (docs/error-map.md).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace millpose {

/// A measured place of a face.
struct ErrorReading {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< in P, mm
  double error = 0;                                 ///< along the normal, mm; above 0: material was left
};

/// A Gaussian process over places: covariance s²·(1 + m(r/ℓ)), where m is Matérn's function of order 5/2 and
/// the 1 an error that all places share (Rasmussen and Williams 2006, chapters 2, 4.2 and 5.4).
class ErrorField {
 public:
  ErrorField() = default;
  /// Through `values` (mm) at `places`, each the mean of `counts` readings; `length` is ℓ, mm, and
  /// `noise_ratio` the variance of one reading ÷ s².
  ErrorField(std::vector<Eigen::Vector3d> places, const Eigen::VectorXd& values,
             const Eigen::VectorXd& counts, double length, double noise_ratio);

  /// The smooth error at a place, mm; 0 for a field without places.
  double At(const Eigen::Vector3d& place) const;
  /// Its standard deviation, mm.
  double DeviationAt(const Eigen::Vector3d& place) const;
  /// Of one reading, mm.
  double noise() const { return noise_; }
  double length() const { return length_; }

 private:
  Eigen::VectorXd Covariances(const Eigen::Vector3d& place) const;

  std::vector<Eigen::Vector3d> places_;
  Eigen::MatrixXd inverse_;  ///< K⁻¹
  Eigen::VectorXd weights_;  ///< K⁻¹·values
  double length_ = 1, scale_ = 0, noise_ = 0;
};

/// A field and what the readings say of it.
struct FittedErrors {
  ErrorField field;
  size_t readings = 0, places = 0;
  double size = 0;       ///< RMS of the readings, mm
  double explained = 0;  ///< share of their squares that the field foretells of places left out, 0..1
  double left = 0;       ///< RMS of what it does not, mm
  std::optional<double> repeatability;  ///< mm, standard deviation of one reading, from places read twice
  /// Nothing of the kind came of the same readings with signs drawn at random, 99 times: less than 1 %
  /// chance.
  bool significant = false;
};

/// Readings nearer than 0.01 mm are of one place; of more than 250 places neighbours are averaged. Length and
/// noise are those that foretell every place best from the others (leave-one-out, exact), of 4 lengths
/// between an eighth of the face's half size and the whole, and 12 levels of noise. The same bits on every
/// machine. At least 6 readings, else nothing is significant.
FittedErrors FitErrors(const std::vector<ErrorReading>& readings);

/// How much of a field comes back on another part.
struct Repeats {
  double share = 0;          ///< factor on the field that fits the other part's readings best
  double low = 0, high = 0;  ///< 95 %
  double left = 0;           ///< mm, RMS of what then remains there
  bool certain() const { return low > 0; }
};

/// Least squares of another part's readings on the field, with Student's interval.
Repeats RepeatsOf(const ErrorField& field, const std::vector<ErrorReading>& other);

}  // namespace millpose
