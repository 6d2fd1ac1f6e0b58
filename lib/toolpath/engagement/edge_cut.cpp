// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/edge_cut.hpp"

#include <algorithm>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr int kLooks = 32;             // at the front of a slice
constexpr int kHalvings = 8;           // of the way between two looks
constexpr double kStepsPerTurn = 192;  // of the integral
// Share of the feed that an edge across the axis must go down by before it cuts: less comes from rounding and
// from the chords of a curved skin, and would put the whole of it into the material or out of it.
constexpr double kGraze = 1e-3;

/// The stance's own frame: ahead, left, up; and the feed in it.
struct StanceFrame {
  explicit StanceFrame(const CutterStance& stance)
      : up(stance.axis), left(stance.Across()), ahead(left.cross(up)) {
    along = stance.feed.dot(ahead);
    rise = stance.feed.dot(up);
  }
  Vector3d Radial(double phi) const {
    const auto [s, c] = SinCos(phi);
    return s * ahead + c * left;
  }

  Vector3d up, left, ahead;
  double along = 1, rise = 0;
};

/// Angles at which a slice moves out of the envelope, start ≥ end: nowhere.
std::pair<double, double> Front(const EdgeSlice& slice, const StanceFrame& frame) {
  const double reach = slice.sin_lead * frame.along, against = slice.cos_lead * frame.rise;
  if (reach <= against) return {0, 0};
  if (reach <= -against) return -against > kGraze ? std::pair(-kPi / 2, 1.5 * kPi) : std::pair(0.0, 0.0);
  const double start = Asin(against / reach);
  return {start, kPi - start};
}

/// Share of the feed that goes out through the envelope.
double OutOf(const EdgeSlice& slice, const StanceFrame& frame, double sine) {
  return slice.sin_lead * frame.along * sine - slice.cos_lead * frame.rise;
}

Vector3d ForceAt(const EdgeModel& model, const EdgeSlice& slice, const StanceFrame& frame,
                 double feed_per_tooth, double phi) {
  const auto [s, c] = SinCos(phi);
  const double chip = feed_per_tooth * OutOf(slice, frame, s);
  if (!(chip > 0)) return Vector3d::Zero();
  const Vector3d f = slice.length * EdgeForce(model, chip);
  const Vector3d radial = s * frame.ahead + c * frame.left;
  const Vector3d normal = slice.sin_lead * radial - slice.cos_lead * frame.up;
  const Vector3d upwards = slice.cos_lead * radial + slice.sin_lead * frame.up;
  // The tool pushes the chip along its motion, which is clockwise: on the tool it acts backwards.
  const Vector3d backwards = s * frame.left - c * frame.ahead;
  return f.x() * backwards - f.y() * normal + f.z() * upwards;
}

/// Integral of the force along an arc, N·rad.
Vector3d ForceOfArc(const EdgeModel& model, const EdgeSlice& slice, const StanceFrame& frame,
                    double feed_per_tooth, const EngagedArc& arc) {
  const double length = arc.end - arc.start;
  const int steps = std::max(4, static_cast<int>(std::ceil(length * kStepsPerTurn / (2 * kPi))));
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < steps; ++i)
    sum += ForceAt(model, slice, frame, feed_per_tooth, arc.start + length * (i + 0.5) / steps);
  return sum * (length / steps);
}

/// Whether the force on two slices is the same at the same angle; it depends on neither radius nor height.
bool FeelsTheSame(const EdgeSlice& a, const EdgeSlice& b) {
  return a.length == b.length && a.sin_lead == b.sin_lead && a.cos_lead == b.cos_lead;
}

}  // namespace

std::vector<EngagedArc> EngagedArcs(const std::vector<EdgeSlice>& slices, const CutterStance& stance,
                                    const InMaterial& in_material) {
  const StanceFrame frame(stance);
  std::vector<EngagedArc> arcs;
  for (size_t k = 0; k < slices.size(); ++k) {
    const EdgeSlice& slice = slices[k];
    const auto [start, end] = Front(slice, frame);
    if (!(start < end)) continue;
    const Vector3d middle = stance.tip + slice.height * frame.up;
    const auto cuts = [&](double phi) { return in_material(middle + slice.radius * frame.Radial(phi)); };
    const double step = (end - start) / kLooks;
    bool before = false;
    double from = start;
    for (int i = 0; i <= kLooks; ++i) {
      const double phi = i < kLooks ? start + (i + 0.5) * step : end;
      const bool here = i < kLooks && cuts(phi);
      if (here == before) continue;
      double edge = i == 0 ? start : end;
      if (i > 0 && i < kLooks) {
        double same = phi - step, other = phi;
        for (int h = 0; h < kHalvings; ++h) {
          const double half = 0.5 * (same + other);
          (cuts(half) == before ? same : other) = half;
        }
        edge = 0.5 * (same + other);
      }
      if (here)
        from = edge;
      else
        arcs.push_back({k, from, edge});
      before = here;
    }
  }
  return arcs;
}

Vector3d MeanForce(const EdgeModel& model, const std::vector<EdgeSlice>& slices, const CutterStance& stance,
                   const std::vector<EngagedArc>& arcs) {
  const StanceFrame frame(stance);
  Vector3d sum = Vector3d::Zero(), part = Vector3d::Zero();
  const EngagedArc* last = nullptr;
  for (const EngagedArc& arc : arcs) {
    // Slices of the cylinder are often in the material alike.
    if (!last || !FeelsTheSame(slices[last->slice], slices[arc.slice]) || last->start != arc.start ||
        last->end != arc.end)
      part = ForceOfArc(model, slices[arc.slice], frame, stance.feed_per_tooth, arc);
    sum += part;
    last = &arc;
  }
  return sum * (model.teeth / (2 * kPi));
}

double PeakForce(const EdgeModel& model, const std::vector<EdgeSlice>& slices, const CutterStance& stance,
                 const std::vector<EngagedArc>& arcs, int steps) {
  const StanceFrame frame(stance);
  const double pitch = 2 * kPi / model.teeth;
  double peak = 0;
  for (int i = 0; i < steps; ++i) {
    Vector3d sum = Vector3d::Zero();
    for (const EngagedArc& arc : arcs) {
      // Teeth stand at i/steps of a pitch, one pitch apart; those within the arc cut.
      const double first = pitch * i / steps;
      for (double phi = first + pitch * std::ceil((arc.start - first) / pitch); phi <= arc.end; phi += pitch)
        sum += ForceAt(model, slices[arc.slice], frame, stance.feed_per_tooth, phi);
    }
    peak = std::max(peak, sum.norm());
  }
  return peak;
}

std::vector<std::pair<double, double>> CutWidths(const std::vector<EdgeSlice>& slices,
                                                 const std::vector<EngagedArc>& arcs) {
  std::vector<std::pair<double, double>> spans;
  for (const EngagedArc& arc : arcs) {
    const double radius = slices[arc.slice].radius;
    // To the left it is r·cos φ, which falls from 0 to 180°; a front that goes on beyond turns back there.
    const double at_start = arc.start < 0 ? 1 : SinCos(arc.start).cos;
    const double at_end = arc.end > kPi ? -1 : SinCos(arc.end).cos;
    spans.emplace_back(radius * std::min(at_start, at_end), radius * std::max(at_start, at_end));
  }
  std::sort(spans.begin(), spans.end());
  std::vector<std::pair<double, double>> merged;
  for (const auto& span : spans) {
    if (merged.empty() || span.first > merged.back().second)
      merged.push_back(span);
    else
      merged.back().second = std::max(merged.back().second, span.second);
  }
  return merged;
}

}  // namespace millpose
