// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_tables.hpp"

#include "base/text.hpp"
#include "planning/result/cycle_time.hpp"
#include "report/page/escaped.hpp"

namespace millpose {
namespace {

std::string TableCell(const std::optional<double>& value) {
  return value ? fmt::format("<td>{:.3f}</td>", *value) : "<td>–</td>";
}

std::string Head(const FoundPlaces& placement, const char* first) {
  std::string text = fmt::format(
      "<div class=\"scroll\"><table><thead><tr><th>{}</th><th>points</th><th>gaps</th>"
      "<th>worst {} ÷</th><th>median ÷</th><th>worst |cF| ÷</th><th>worst |n'cF| ÷</th>"
      "<th>clearance, mm</th>",
      first, Escaped(placement.objective));
  for (const auto& [controller, seconds] : placement.plans.front().cycle)
    text += "<th>" + Escaped(controller) + ", h:min:s</th>";
  return text + "</tr></thead><tbody>";
}

/// A plan's row; `name` is HTML.
std::string Row(const FoundPlaces& placement, const PlannedPlace& plan, const std::string& name, bool best) {
  const PlannedPlace& own = placement.plans.front();
  std::string text =
      fmt::format("<tr{}><td>{}</td><td>{} of {}</td><td>{} of {}</td>", best ? " class=\"best\"" : "", name,
                  plan.planned, plan.points, plan.gaps_planned, plan.gaps);
  text += TableCell(RatioOf(plan.worst, own.worst)) + TableCell(RatioOf(plan.median, own.median)) +
          TableCell(RatioOf(plan.length, own.length)) + TableCell(RatioOf(plan.normal, own.normal));
  text += plan.clearance ? fmt::format("<td>{:.1f}</td>", *plan.clearance) : "<td>–</td>";
  for (const auto& [controller, seconds] : own.cycle)
    text += plan.cycle.contains(controller) ? fmt::format("<td>{}</td>", ClockText(plan.cycle.at(controller)))
                                            : "<td>–</td>";
  return text + "</tr>";
}

std::string Linked(const PlannedPlace& plan, const std::string& name) {
  return fmt::format("<a href=\"{}/report.html\">{}</a> {}", Escaped(plan.folder), Escaped(name),
                     Escaped(Describe(plan.place)));
}

}  // namespace

std::string CoordinateLabel(size_t coordinate) {
  const std::string key = kPlaceKeys[coordinate];
  return key.substr(0, 1) + (coordinate < 3 ? ", mm" : ", °");
}

std::string PlansTable(const FoundPlaces& placement) {
  std::string text = Head(placement, "place");
  for (size_t i = 0; i < placement.plans.size(); ++i)
    text +=
        Row(placement, placement.plans[i], Linked(placement.plans[i], i == 0 ? "job" : fmt::format("{}", i)),
            i > 0 && i == placement.recommended && !placement.split);
  return text + "</tbody></table></div>";
}

std::string NearbyTable(const std::vector<Sensitivity>& sensitivity) {
  std::string text =
      "<table><thead><tr><th>coordinate</th><th>changed by</th><th>points free</th><th>worst "
      "÷</th></tr></thead><tbody>";
  for (const Sensitivity& one : sensitivity)
    text +=
        fmt::format("<tr><td>{}</td><td>{:+g}</td><td>{} of {}</td>{}</tr>", CoordinateLabel(one.coordinate),
                    one.by, one.rated.score.free(), one.rated.score.total(), TableCell(one.rated.worst));
  return text + "</tbody></table>";
}

std::string StationsSection(const FoundPlaces& placement) {
  if (placement.splits.empty()) return "";
  const Eigen::Vector3d& along = placement.split_rule->along;
  std::string text = fmt::format(
      "<section><h2>Split between stations</h2><p>Along ({}, {}, {}) of the part; neighbours overlap by {} "
      "mm. "
      "{}</p>",
      ShortestNumber(along.x()), ShortestNumber(along.y()), ShortestNumber(along.z()),
      ShortestNumber(placement.split_rule->overlap), placement.split ? "" : "No split is worth moving for.");
  text += Head(placement, "stations");
  for (size_t i = 0; i < placement.splits.size(); ++i) {
    const PlannedSplit& split = placement.splits[i];
    const bool best = placement.split && i == *placement.split;
    text += Row(placement, split.Whole(), fmt::format("{} stations", split.stations.size()), best);
    for (const PlannedStation& station : split.stations)
      text += Row(placement, station.plan, Linked(station.plan, SpanText(station.share)), false);
  }
  text += "</tbody></table></div>";
  if (placement.split)
    for (const PlannedStation& station : placement.splits[*placement.split].stations)
      text += fmt::format("<p>How well the station {} must be met:</p>{}", SpanText(station.share),
                          NearbyTable(station.sensitivity));
  return text + "</section>";
}

}  // namespace millpose
