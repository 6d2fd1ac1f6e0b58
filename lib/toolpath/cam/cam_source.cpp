// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/cam_source.hpp"

#include <fmt/format.h>

#include <cmath>

namespace millpose {
namespace {

// "12,000": whole revolutions per minute with commas, others with their decimals.
std::string PerMinute(double speed) {
  const double rpm = speed * 60, whole = std::round(rpm);
  if (std::abs(rpm - whole) > 0.05) return fmt::format("{:.6g}", rpm);
  std::string digits = fmt::format("{:.0f}", whole);
  for (auto at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<size_t>(at), ",");
  return digits;
}

bool Same(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || std::abs(*a - *b) <= 1e-6 * (1 + std::abs(*a)));
}

}  // namespace

bool CamSection::SameAs(const CamSection& other) const {
  return tool == other.tool && Same(diameter, other.diameter) && Same(corner_radius, other.corner_radius) &&
         Same(speed, other.speed) && sense == other.sense;
}

std::string CamSection::ToText() const {
  std::string text = tool.empty() ? "tool not named" : "tool " + tool.substr(0, 40);
  if (diameter) text += fmt::format(" D{:.6g}", *diameter);
  if (speed) text += fmt::format(" at {}/min", PerMinute(*speed));
  if (sense != SpindleSense::kNotStated)
    text += sense == SpindleSense::kClockwise ? " clockwise" : " counter-clockwise";
  return text;
}

std::string CamSource::ToText() const {
  std::string text = fmt::format("{}, {}, frame {}", sender, unit, frame);
  if (!three_numbers.empty()) text += ", three numbers = " + three_numbers;
  for (const CamSection& section : sections)
    text +=
        fmt::format("{} {}", sections.size() > 1 && &section != &sections[0] ? ";" : ",", section.ToText());
  return text;
}

}  // namespace millpose
