// SPDX-License-Identifier: GPL-3.0-or-later
// The smooth part of a milled face's measured error (docs/error-map.md).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "machine/motion/lost_motion.hpp"

namespace millpose {

/// A place of a face and how the arm's gears stood when the tool passed it.
struct MilledPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in P, mm
  /// On which flanks the gears stood, each with its lever along the normal, mm/rad (FlankLevers()); zero: not
  /// known.
  GearValues flanks = GearValues::Zero();
};

/// What was measured at one.
struct ErrorReading {
  MilledPlace place;
  double error = 0;  ///< along the normal, mm; above 0: material was left
};

/// A Gaussian process over places (Rasmussen and Williams 2006, chapters 2, 4.2 and 5.4) with covariance
/// s²·(1 + m(r/ℓ) + a·g·g'): m is Matérn's function of order 5/2 over their distance r, the 1 beside it an
/// error that all places share. g are the flanks, in units of their RMS length: each gear leaves the
/// unknown half of its lost motion times its lever, one way there and the other way back.
class ErrorField {
 public:
  ErrorField() = default;
  struct Shape {
    double length = 1;       ///< ℓ, mm
    double by_flanks = 0;    ///< a ÷ the mean square of g, rad²/mm²
    double noise_ratio = 1;  ///< variance of one reading ÷ s²
  };
  /// Through `values` (mm) at `places`, each the mean of `counts` readings.
  ErrorField(std::vector<MilledPlace> places, const Eigen::VectorXd& values, const Eigen::VectorXd& counts,
             const Shape& shape);

  /// The smooth error at a place, mm; 0 for a field without places.
  double At(const MilledPlace& place) const;
  /// Its standard deviation, mm.
  double DeviationAt(const MilledPlace& place) const;
  /// Of one reading, mm.
  double noise() const { return noise_; }
  const Shape& shape() const { return shape_; }

 private:
  Eigen::VectorXd Covariances(const MilledPlace& place) const;

  std::vector<MilledPlace> places_;
  Eigen::MatrixXd inverse_;  ///< K⁻¹
  Eigen::VectorXd weights_;  ///< K⁻¹·values
  Shape shape_;
  double scale_ = 0, noise_ = 0;
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

/// Readings nearer than 0.01 mm are of one place; of more than 250 places neighbours that were passed on the
/// same flanks are averaged. Length, share that follows the flanks, and noise are those that foretell every
/// place best from the others (leave-one-out, exact): of 4 lengths between an eighth of the face's half size
/// and the whole, a of 0 and 1, and 8 levels of noise. The same bits on every machine. At least 6 readings,
/// else nothing is significant.
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
