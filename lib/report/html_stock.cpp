// SPDX-License-Identifier: GPL-3.0-or-later
// The material of report.html while it is milled off.
#include "report/html_json.hpp"
#include "report/packed.hpp"

namespace millpose::html {
namespace {

constexpr double kSteps = 65534;  // of 16 bits; what is none has its ends the wrong way round
constexpr double kMm3PerCm3 = 1000;

/// Ends of spans as steps of a range, two by two.
class PackedSpans {
 public:
  explicit PackedSpans(const Removal& removal) {
    for (const auto* spans : {&removal.blank, &removal.part})
      for (const Span& span : *spans) {
        if (span.high < span.low) continue;
        low_ = empty_ ? span.low : std::min(low_, span.low);
        high_ = empty_ ? span.high : std::max(high_, span.high);
        empty_ = false;
      }
  }

  Json Range() const { return {low_, high_}; }

  std::string Pack(const std::vector<Span>& spans) const {
    std::vector<uint16_t> steps;
    steps.reserve(2 * spans.size());
    for (const Span& span : spans) {
      const bool none = span.high < span.low;
      steps.push_back(none ? 65535 : Step(span.low));
      steps.push_back(none ? 0 : Step(span.high));
    }
    return PackUint16(steps);
  }

 private:
  uint16_t Step(double at) const {
    return static_cast<uint16_t>(std::round(kSteps * std::clamp((at - low_) / (high_ - low_), 0.0, 1.0)));
  }

  double low_ = 0, high_ = 1;
  bool empty_ = true;
};

}  // namespace

Json RemovalJson(const Removal* removal) {
  if (!removal || removal->frames.empty()) return nullptr;
  const PackedSpans packed(*removal);
  std::vector<float> time, left;
  std::vector<uint32_t> changed;
  for (const Removal::Frame& frame : removal->frames) {
    time.push_back(static_cast<float>(frame.time));
    left.push_back(static_cast<float>(frame.volume / kMm3PerCm3));
    changed.push_back(static_cast<uint32_t>(frame.changed));
  }
  const Eigen::Vector3d& origin = removal->origin;
  return {{"along", removal->along},
          {"origin_mm", {origin.x(), origin.y(), origin.z()}},
          {"spacing_mm", removal->spacing},
          {"rows", removal->rows},
          {"columns", removal->columns},
          {"range_mm", packed.Range()},
          {"cm3", removal->volume / kMm3PerCm3},
          {"blank", packed.Pack(removal->blank)},
          {"part", packed.Pack(removal->part)},
          {"time_s", PackFloats(time)},
          {"left_cm3", PackFloats(left)},
          {"changed", PackUint32(changed)},
          {"lines", PackUint32(removal->lines)},
          {"ends", packed.Pack(removal->ends)}};
}

}  // namespace millpose::html
