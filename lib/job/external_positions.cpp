// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/external_positions.hpp"

#include "base/error.hpp"
#include "planning/pose/freedom_entry.hpp"

namespace millpose {
namespace {

constexpr size_t kMostPositions = 2000;       // of all axes together
constexpr size_t kMostOfContinuous = 200;     // likewise, where one may move along passes: pairs count
constexpr double kSteps = 8;                  // that a linear axis' range falls into
constexpr double kRotaryStep = DegToRad(30);  // of a rotary one
constexpr double kTurn = 2 * kPi, kSameAngle = 1e-9;  // rad

/// Evenly from `lower` to `upper`, at most `step` apart.
std::vector<double> Grid(double lower, double upper, double step) {
  const int count = std::max(1, static_cast<int>(std::ceil((upper - lower) / step - kSameAngle)));
  std::vector<double> values;
  for (int i = 0; i <= count; ++i) values.push_back(lower + (upper - lower) * i / count);
  return values;
}

std::vector<double> ValuesToChoose(const ExternalAxis& axis, const ExternalSettings& external) {
  if (axis.kind == AxisKind::kLinear)
    return Grid(axis.lower, axis.upper, external.step_mm.value_or((axis.upper - axis.lower) / kSteps));
  const double step = external.step_deg.value_or(kRotaryStep);
  // One that turns along a pass does not come to the same by a turn more.
  if (external.scope == ExternalScope::kContinuous) return Grid(axis.lower, axis.upper, step);
  if (axis.upper - axis.lower < kTurn - kSameAngle) return Grid(axis.lower, axis.upper, step);
  // More than a turn: the one about home, whose ends are the same.
  const double lower = std::clamp(axis.home - kPi, axis.lower, axis.upper - kTurn);
  std::vector<double> values = Grid(lower, lower + kTurn, step);
  values.pop_back();
  return values;
}

const ExternalSettings* EntryOf(const JobSettings& job, const std::string& axis) {
  const auto found = std::ranges::find(job.external, axis, &ExternalSettings::axis);
  return found == job.external.end() ? nullptr : &*found;
}

/// One entry against its axis.
void CheckEntry(const ExternalAxis& axis, const ExternalSettings& entry, const std::string& path,
                const std::function<void(std::string)>& add) {
  const bool linear = axis.kind == AxisKind::kLinear;
  const char* own = linear ? "mm" : "deg";
  const auto wrong_unit = [&](const char* key, const std::optional<double>& given) {
    if (given)
      add(fmt::format("{}.{}_{}: has no effect here: axis {} is {}; allowed: {}_{}", path, key,
                      linear ? "deg" : "mm", axis.name, WordOf(kAxisKindWords, axis.kind), key, own));
  };
  wrong_unit("at", linear ? entry.at_deg : entry.at_mm);
  wrong_unit("step", linear ? entry.step_deg : entry.step_mm);
  const std::optional<double>& at = linear ? entry.at_mm : entry.at_deg;
  const auto shown = [&](double value) { return linear ? value : RadToDeg(value); };
  if (at && (*at < axis.lower || *at > axis.upper))
    add(fmt::format("{}.at_{}: given {:g}; allowed: {:g} to {:g}, the limits of {}", path, own, shown(*at),
                    shown(axis.lower), shown(axis.upper), axis.name));
}

}  // namespace

std::vector<AxisPositions> PositionsOf(const JobSettings& job, const CellSettings& cell) {
  std::vector<AxisPositions> positions;
  for (const ExternalAxis& axis : cell.external_axes) {
    AxisPositions& own = positions.emplace_back();
    const ExternalSettings* entry = EntryOf(job, axis.name);
    if (!entry) {
      own.values = {axis.home};
      continue;
    }
    own.continuous = entry->scope == ExternalScope::kContinuous;
    own.per_pass = own.continuous || entry->scope == ExternalScope::kPerPass;
    const std::optional<double>& at = axis.kind == AxisKind::kLinear ? entry->at_mm : entry->at_deg;
    own.values = at ? std::vector<double>{*at} : ValuesToChoose(axis, *entry);
  }
  return positions;
}

std::vector<Problem> CheckExternal(const JobSettings& job, const CellSettings& cell) {
  std::vector<Problem> problems;
  std::vector<std::string> names;
  for (const ExternalAxis& axis : cell.external_axes) names.push_back(axis.name);
  const auto add = [&](std::string message) { problems.push_back({{job.file}, std::move(message)}); };
  for (size_t i = 0; i < job.external.size(); ++i) {
    const ExternalSettings& entry = job.external[i];
    const std::string path = fmt::format("external[{}]", i);
    const auto axis = std::ranges::find(cell.external_axes, entry.axis, &ExternalAxis::name);
    if (axis == cell.external_axes.end()) {
      const std::string nearest = NearestName(entry.axis, names);
      add(fmt::format("{}.axis: given '{}'; allowed: the external axes of cell {}: {}{}", path, entry.axis,
                      cell.name, names.empty() ? "it has none" : fmt::format("{}", fmt::join(names, ", ")),
                      nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
      continue;
    }
    if (EntryOf(job, entry.axis) != &entry) add(fmt::format("{}.axis: given {} twice", path, entry.axis));
    CheckEntry(*axis, entry, path, add);
  }
  if (!problems.empty()) return problems;
  double count = 1;
  bool continuous = false;
  for (const AxisPositions& positions : PositionsOf(job, cell)) {
    count *= static_cast<double>(positions.values.size());
    continuous = continuous || positions.continuous;
  }
  const size_t most = continuous ? kMostOfContinuous : kMostPositions;
  if (count > static_cast<double>(most))
    add(fmt::format("external: given steps make {:.0f} positions; allowed: up to {}{}, with larger steps",
                    count, most, continuous ? " where an axis has scope continuous" : ""));
  if (continuous && job.toolpath.Leans())
    add(fmt::format(
        "external: given scope continuous, and ranges for toolpath.{}; allowed: one of them: gouges "
        "are not looked for on a part that moves",
        LeanKeys()));
  return problems;
}

}  // namespace millpose
