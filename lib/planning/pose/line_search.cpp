// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/line_search.hpp"

#include <algorithm>
#include <cmath>

namespace millpose {
namespace {

constexpr double kGoldenRatio = 0.61803398874989484820;

}  // namespace

LineSearch::LineSearch(double start, double value, double step, double reach, double tolerance,
                       double end_tolerance)
    : start_(start),
      start_value_(value),
      step_(step),
      reach_(reach),
      tolerance_(tolerance),
      end_tolerance_(end_tolerance),
      best_(start),
      best_value_(value),
      asked_(start + step) {}

void LineSearch::Tell(double value) {
  if (value < best_value_) best_ = asked_, best_value_ = value;
  const bool admissible = std::isfinite(value);
  switch (phase_) {
    case Phase::kRight:
      right_value_ = value;
      phase_ = Phase::kLeft;
      asked_ = start_ - step_;
      break;
    case Phase::kLeft:
      left_value_ = value;
      Choose();
      break;
    case Phase::kDescend: {
      const bool fell = value < here_value_;
      if (fell && std::abs(asked_ - start_) < reach_) {
        before_ = here_, here_ = asked_, here_value_ = value;
        Descend();
        break;
      }
      // The minimum lies between `before_` and where the value rose, or where the interval ends on the way.
      End& ahead = direction_ > 0 ? right_ : left_;
      End& behind = direction_ > 0 ? left_ : right_;
      ahead = admissible ? End{asked_, asked_, false} : End{here_, asked_, true};
      behind = {before_, before_, false};
      CloseEnds();
      break;
    }
    case Phase::kEndRight:
    case Phase::kEndLeft: {
      End& end = phase_ == Phase::kEndRight ? right_ : left_;
      (admissible ? end.inside : end.outside) = asked_;
      CloseEnds();
      break;
    }
    case Phase::kGoldenFirst:
      inner_left_value_ = value;
      phase_ = Phase::kGolden;
      asked_left_ = false;
      asked_ = inner_right_;
      break;
    case Phase::kGolden:
      (asked_left_ ? inner_left_value_ : inner_right_value_) = value;
      StepGolden();
      break;
    case Phase::kDone:
      break;
  }
}

void LineSearch::Choose() {
  if (std::min(left_value_, right_value_) < start_value_) {
    direction_ = right_value_ <= left_value_ ? 1.0 : -1.0;
    before_ = start_;
    here_ = start_ + direction_ * step_;
    here_value_ = std::min(left_value_, right_value_);
    Descend();
    return;
  }
  right_ = {std::isfinite(right_value_) ? start_ + step_ : start_, start_ + step_,
            !std::isfinite(right_value_)};
  left_ = {std::isfinite(left_value_) ? start_ - step_ : start_, start_ - step_, !std::isfinite(left_value_)};
  CloseEnds();
}

void LineSearch::Descend() {
  phase_ = Phase::kDescend;
  asked_ = here_ + 2.0 * (here_ - before_);
}

void LineSearch::CloseEnds() {
  for (const bool right : {true, false}) {
    End& end = right ? right_ : left_;
    const double middle = 0.5 * (end.inside + end.outside);
    if (!end.open || std::abs(end.outside - end.inside) <= end_tolerance_ || middle == end.inside ||
        middle == end.outside) {
      continue;
    }
    phase_ = right ? Phase::kEndRight : Phase::kEndLeft;
    asked_ = middle;
    return;
  }
  StartGolden();
}

void LineSearch::StartGolden() {
  const double width = right_.inside - left_.inside;
  if (width <= tolerance_) {
    phase_ = Phase::kDone;
    return;
  }
  inner_left_ = right_.inside - kGoldenRatio * width;
  inner_right_ = left_.inside + kGoldenRatio * width;
  phase_ = Phase::kGoldenFirst;
  asked_ = inner_left_;
}

void LineSearch::StepGolden() {
  const bool keep_left = inner_left_value_ < inner_right_value_;
  (keep_left ? right_.inside : left_.inside) = keep_left ? inner_right_ : inner_left_;
  const double width = right_.inside - left_.inside;
  if (width <= tolerance_) {
    phase_ = Phase::kDone;
    return;
  }
  asked_left_ = keep_left;
  if (keep_left) {
    inner_right_ = inner_left_, inner_right_value_ = inner_left_value_;
    asked_ = inner_left_ = right_.inside - kGoldenRatio * width;
  } else {
    inner_left_ = inner_right_, inner_left_value_ = inner_right_value_;
    asked_ = inner_right_ = left_.inside + kGoldenRatio * width;
  }
}

}  // namespace millpose
