// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_tables.hpp"

#include "base/text.hpp"
#include "planning/result/cycle_time.hpp"
#include "report/page/escaped.hpp"

namespace millpose {
namespace {

std::string Number(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "–";
}

std::string SaidHere(Language language, const std::string& english) {
  return Escaped(Say(language, english));
}

/// A head; behind one word ÷ never begins a line.
std::string HeadText(Language language, const std::string& english) {
  std::string text = SaidHere(language, english);
  if (const size_t at = text.find(' '); at != std::string::npos && text.substr(at) == " ÷")
    text.replace(at, 1, "&nbsp;");
  return text;
}

/// The heads of a row's cells behind its name.
std::vector<std::string> Heads(const FoundPlaces& placement, Language language) {
  std::vector<std::string> heads;
  for (const std::string& column :
       {std::string("points"), std::string("gaps"), fmt::format("worst {} ÷", placement.objective),
        std::string("median ÷"), std::string("worst |cF| ÷"), std::string("worst |n'cF| ÷"),
        std::string("clearance, mm")})
    heads.push_back(HeadText(language, column));
  for (const auto& [controller, seconds] : placement.plans.front().cycle)
    heads.push_back(Escaped(controller) + ", h:min:s");
  return heads;
}

std::string Head(const FoundPlaces& placement, const char* first, Language language) {
  std::string text =
      "<div class=\"scroll plans\"><table><thead><tr><th>" + SaidHere(language, first) + "</th>";
  for (const std::string& head : Heads(placement, language)) text += "<th>" + head + "</th>";
  return text + "</tr></thead><tbody>";
}

/// A plan's row; `name` is HTML. Each cell carries its head, which stands before it on a narrow page.
std::string Row(const FoundPlaces& placement, const PlannedPlace& plan, const std::string& name, bool best,
                Language language) {
  const PlannedPlace& own = placement.plans.front();
  std::vector<std::string> cells{SaidHere(language, fmt::format("{} of {}", plan.planned, plan.points)),
                                 SaidHere(language, fmt::format("{} of {}", plan.gaps_planned, plan.gaps)),
                                 Number(RatioOf(plan.worst, own.worst), 3),
                                 Number(RatioOf(plan.median, own.median), 3),
                                 Number(RatioOf(plan.length, own.length), 3),
                                 Number(RatioOf(plan.normal, own.normal), 3),
                                 Number(plan.clearance, 1)};
  for (const auto& [controller, seconds] : own.cycle)
    cells.push_back(plan.cycle.contains(controller) ? ClockText(plan.cycle.at(controller)) : "–");
  const std::vector<std::string> heads = Heads(placement, language);
  std::string text = fmt::format("<tr{}><td>{}</td>", best ? " class=\"best\"" : "", name);
  for (size_t i = 0; i < cells.size(); ++i)
    text += fmt::format("<td data-head=\"{}\">{}</td>", heads[i], cells[i]);
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
    text += "<th>" + HeadText(language, column) + "</th>";
  text += "</tr></thead><tbody>";
  for (const Sensitivity& one : sensitivity)
    text += fmt::format(
        "<tr><td>{}</td><td>{:+g}</td><td>{}</td><td>{}</td></tr>", CoordinateLabel(one.coordinate), one.by,
        SaidHere(language, fmt::format("{} of {}", one.rated.score.free(), one.rated.score.total())),
        Number(one.rated.worst, 3));
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
