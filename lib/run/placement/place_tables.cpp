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

std::string SaidHere(Language language, const std::string& english) {
  return Escaped(Say(language, english));
}

std::string Head(const FoundPlaces& placement, const char* first, Language language) {
  std::string text = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& column :
       {std::string(first), std::string("points"), std::string("gaps"),
        fmt::format("worst {} ÷", placement.objective), std::string("median ÷"), std::string("worst |cF| ÷"),
        std::string("worst |n'cF| ÷"), std::string("clearance, mm")})
    text += "<th>" + SaidHere(language, column) + "</th>";
  for (const auto& [controller, seconds] : placement.plans.front().cycle)
    text += "<th>" + Escaped(controller) + ", h:min:s</th>";
  return text + "</tr></thead><tbody>";
}

/// A plan's row; `name` is HTML.
std::string Row(const FoundPlaces& placement, const PlannedPlace& plan, const std::string& name, bool best,
                Language language) {
  const PlannedPlace& own = placement.plans.front();
  std::string text = fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td>", best ? " class=\"best\"" : "",
                                 name, SaidHere(language, fmt::format("{} of {}", plan.planned, plan.points)),
                                 SaidHere(language, fmt::format("{} of {}", plan.gaps_planned, plan.gaps)));
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

std::string PlansTable(const FoundPlaces& placement, Language language) {
  std::string text = Head(placement, "place", language);
  for (size_t i = 0; i < placement.plans.size(); ++i)
    text += Row(placement, placement.plans[i],
                Linked(placement.plans[i], i == 0 ? Say(language, "job") : fmt::format("{}", i)),
                i > 0 && i == placement.recommended && !placement.split, language);
  return text + "</tbody></table></div>";
}

std::string NearbyTable(const std::vector<Sensitivity>& sensitivity, Language language) {
  std::string text = "<table><thead><tr>";
  for (const char* column : {"coordinate", "changed by", "points free", "worst ÷"})
    text += "<th>" + SaidHere(language, column) + "</th>";
  text += "</tr></thead><tbody>";
  for (const Sensitivity& one : sensitivity)
    text += fmt::format(
        "<tr><td>{}</td><td>{:+g}</td><td>{}</td>{}</tr>", CoordinateLabel(one.coordinate), one.by,
        SaidHere(language, fmt::format("{} of {}", one.rated.score.free(), one.rated.score.total())),
        TableCell(one.rated.worst));
  return text + "</tbody></table>";
}

std::string StationsSection(const FoundPlaces& placement, Language language) {
  if (placement.splits.empty()) return "";
  const Eigen::Vector3d& along = placement.split_rule->along;
  std::string text =
      "<section><h2>" + SaidHere(language, "Split between stations") + "</h2><p>" +
      SaidHere(language, fmt::format("Along ({}, {}, {}) of the part; neighbours overlap by {} mm.{}",
                                     ShortestNumber(along.x()), ShortestNumber(along.y()),
                                     ShortestNumber(along.z()), ShortestNumber(placement.split_rule->overlap),
                                     placement.split ? "" : " No split is worth moving for.")) +
      "</p>";
  text += Head(placement, "stations", language);
  for (size_t i = 0; i < placement.splits.size(); ++i) {
    const PlannedSplit& split = placement.splits[i];
    const bool best = placement.split && i == *placement.split;
    text += Row(placement, split.Whole(),
                SaidHere(language, fmt::format("{} stations", split.stations.size())), best, language);
    for (const PlannedStation& station : split.stations)
      text += Row(placement, station.plan, Linked(station.plan, Say(language, SpanText(station.share))),
                  false, language);
  }
  text += "</tbody></table></div>";
  if (placement.split)
    for (const PlannedStation& station : placement.splits[*placement.split].stations)
      text += fmt::format(
          "<p>{}</p>{}",
          SaidHere(language, fmt::format("How well the station {} must be met:", SpanText(station.share))),
          NearbyTable(station.sensitivity, language));
  return text + "</section>";
}

}  // namespace millpose
