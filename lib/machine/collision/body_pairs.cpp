// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/body_pairs.hpp"

#include <algorithm>

namespace millpose {

int LinkOf(const Body& body) {
  if (body.mount == Mount::kTool) return 6;
  return body.mount == Mount::kLink ? body.link : 0;
}

int LastCarrier(const std::vector<ExternalAxis>& axes, Carries carried) {
  int last = kNoCarrier;
  for (size_t i = 0; i < axes.size(); ++i)
    if (axes[i].carries == carried) last = static_cast<int>(i);
  return last;
}

int CarrierOf(const std::vector<ExternalAxis>& axes, const Body& body) {
  switch (body.mount) {
    case Mount::kCarriage:
      return body.axis;
    case Mount::kWorkpiece:
      return LastCarrier(axes, Carries::kWorkpiece);
    case Mount::kLink:
    case Mount::kTool:
      return LastCarrier(axes, Carries::kRobot);
    case Mount::kWorld:
      break;
  }
  return kNoCarrier;
}

int CarrierOfAxis(const std::vector<ExternalAxis>& axes, int axis) {
  for (int i = axis - 1; i >= 0; --i)
    if (axes[static_cast<size_t>(i)].carries == axes[static_cast<size_t>(axis)].carries) return i;
  return kNoCarrier;
}

bool MeetInAxis(const std::vector<ExternalAxis>& axes, const Body& a, const Body& b) {
  const auto guided = [](const Body& body) {
    return body.mount == Mount::kCarriage || (body.mount == Mount::kLink && body.link == 0);
  };
  const int first = CarrierOf(axes, a), second = CarrierOf(axes, b);
  if (first == kNoCarrier || second == kNoCarrier || !guided(a) || !guided(b)) return false;
  return CarrierOfAxis(axes, first) == second || CarrierOfAxis(axes, second) == first;
}

bool MeetInArm(const Body& a, const Body& b) {
  const int link_a = LinkOf(a), link_b = LinkOf(b);
  if (link_a == link_b) return true;
  return a.body_class == BodyClass::kLink && b.body_class == BodyClass::kLink &&
         std::abs(link_a - link_b) == 1;
}

bool IsExcluded(const Cell& cell, const Body& a, const Body& b) {
  return std::ranges::any_of(cell.excluded_pairs, [&](const auto& pair) {
    return pair == std::pair(a.name, b.name) || pair == std::pair(b.name, a.name);
  });
}

bool NeverChecked(const Cell& cell, const Body& a, const Body& b) {
  if (IsExcluded(cell, a, b)) return true;
  if (!MeetInArm(a, b)) return false;
  if (LinkOf(a) > 0 || LinkOf(b) > 0) return true;
  return CarrierOf(cell.external_axes, a) == CarrierOf(cell.external_axes, b) ||
         MeetInAxis(cell.external_axes, a, b);
}

}  // namespace millpose
