// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

namespace millpose {

/// Descends along one coordinate from an admissible start to the nearest local minimum, which may lie on the
/// end of the admissible interval. Ask and tell, so that a caller can run many searches side by side: steps
/// that double until the value rises or the interval ends, bisection onto the interval's end, golden section
/// (Kiefer 1953) inside.
class LineSearch {
 public:
  /// `reach` bounds the way on either side; the minimum is located to `tolerance`, an interval's end to
  /// `end_tolerance`; `step` is the first step.
  LineSearch(double start, double value, double step, double reach, double tolerance, double end_tolerance);

  bool done() const { return phase_ == Phase::kDone; }
  /// The coordinate at which the value is wanted next; not to be called when done.
  double Ask() const { return asked_; }
  /// The value there; +inf where it is not admissible.
  void Tell(double value);

  double best() const { return best_; }
  double best_value() const { return best_value_; }

 private:
  enum class Phase { kRight, kLeft, kDescend, kEndRight, kEndLeft, kGoldenFirst, kGolden, kDone };
  struct End {
    double inside, outside;  ///< admissible, and not
    bool open = false;       ///< `outside` is known not to be admissible
  };

  void Choose();
  void Descend();
  void CloseEnds();
  void StartGolden();
  void StepGolden();

  double start_, start_value_, step_, reach_, tolerance_, end_tolerance_;
  double best_, best_value_;
  Phase phase_ = Phase::kRight;
  double asked_;
  double right_value_ = 0, left_value_ = 0;
  double direction_ = 0, before_ = 0, here_ = 0, here_value_ = 0;
  End left_, right_;
  double inner_left_ = 0, inner_right_ = 0, inner_left_value_ = 0, inner_right_value_ = 0;
  bool asked_left_ = true;
};

}  // namespace millpose
