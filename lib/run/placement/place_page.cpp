// SPDX-License-Identifier: GPL-3.0-or-later
// placement.html: one file that loads nothing and needs no script.
#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_point.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>

#include "base/text.hpp"
#include "machine/robot/make_pose.hpp"
#include "report/page/escaped.hpp"
#include "report/page/table_page.hpp"
#include "run/placement/place_tables.hpp"

namespace millpose {
namespace {

namespace bg = boost::geometry;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr const char* kStyle = R"html(body { margin: 0 auto; max-width: 1200px; }
section { background: var(--card); border: 1px solid var(--line); border-radius: 5px; padding: 10px 12px; margin-bottom: 10px; break-inside: avoid; }
.scroll { border: 0; margin: 0; }
.two { display: flex; flex-wrap: wrap; gap: 10px; align-items: flex-start; }
.two section { flex: 1 1 340px; min-width: 0; }
th, td { padding: 4px 8px; text-align: right; font-variant-numeric: tabular-nums; }
th { white-space: normal; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; white-space: normal; }
tr.best td { font-weight: 600; }
svg { display: block; width: 100%; height: auto; }
svg text { fill: var(--ink); }
.legend { display: flex; flex-wrap: wrap; gap: 4px 14px; color: var(--muted); margin-top: 6px; }
.legend i { display: inline-block; width: 12px; height: 12px; margin-right: 5px; vertical-align: -2px; border: 1px solid var(--line); print-color-adjust: exact; }
p { margin: 0 0 6px; color: var(--muted); }
/* A place is a block of lines, head and figure, where its row would not fit. */
@media (max-width: 900px) {
  th, td { padding: 4px 4px; }
  th { overflow-wrap: anywhere; hyphens: auto; }
  .plans thead { display: none; }
  .plans table, .plans tbody, .plans td { display: block; }
  .plans tr { display: grid; grid-template-columns: repeat(auto-fill, minmax(220px, 1fr)); gap: 0 28px; padding: 4px 0; border-bottom: 1px solid var(--line); }
  .plans tr:last-child { border-bottom: 0; }
  .plans td { display: flex; justify-content: space-between; gap: 12px; padding: 1px 0; border: 0; white-space: normal; }
  .plans td:first-child { display: block; grid-column: 1 / -1; overflow-wrap: anywhere; }
  .plans td::before { content: attr(data-head); color: var(--muted); font-weight: 400; }
}
)html";

/// What a place that cannot be is drawn in; each differs from the others in brightness too.
const std::map<std::string, std::string>& CauseColours() {
  static const std::map<std::string, std::string> colours{{"unreachable", "#8a8f98"},
                                                          {"limit", "#a3a8b0"},
                                                          {"singular", "#b9bec5"},
                                                          {"interference", "#cfd3d8"},
                                                          {"step", "#b39ddb"}};
  return colours;
}
constexpr const char* kTouches = "#e9ebee";

std::string CauseColour(const std::string& cause) {
  const auto found = CauseColours().find(cause);
  return found == CauseColours().end() ? kTouches : found->second;
}

/// Places on viridis, bright is worse as in every report: 0 (best) violet, 1 yellow.
std::string Colour(double share) {
  constexpr std::array<std::array<int, 3>, 5> kStops{
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const size_t i = std::min(kStops.size() - 2, static_cast<size_t>(at));
  const double t = at - static_cast<double>(i);
  const auto mix = [&](size_t k) {
    return static_cast<int>(std::lround((1 - t) * kStops[i][k] + t * kStops[i + 1][k]));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

/// Between which ratios the colours of a map run: beyond the worse end all look alike.
std::pair<double, double> ScaleOf(const FoundPlaces& placement) {
  std::vector<double> all;
  for (const RatedPlace& rated : placement.map)
    if (rated.worst && CauseOf(rated.score).empty()) all.push_back(*rated.worst);
  if (all.empty()) return {0, 1};
  std::ranges::sort(all);
  const double least = all.front(), most = all[all.size() * 9 / 10];
  return {least, most > least ? most : least + 1e-9};
}

std::string Told(const FoundPlaces& placement, const RatedPlace& rated, Language language) {
  const std::string cause = CauseOf(rated.score), place = Describe(rated.score.place) + ": ";
  if (!rated.score.touches.empty()) return place + Say(language, "touches " + rated.score.touches);
  std::string text;
  if (rated.worst)
    text = Say(language, fmt::format("worst {} ÷ job's own {:.3f}", placement.objective, *rated.worst));
  if (!cause.empty())
    text += (rated.worst ? ", " : "") +
            Say(language, fmt::format("{} of {} points free, most others: {}", rated.score.free(),
                                      rated.score.total(), cause));
  return place + text;
}

std::string MapSvg(const FoundPlaces& placement, Language language) {
  const auto [least, most] = ScaleOf(placement);
  const size_t columns = placement.map_columns, rows = placement.map.size() / columns;
  const size_t u = placement.map_coordinates[0], v = placement.map_coordinates[1];
  const double width = 560, cell = width / static_cast<double>(columns),
               high = rows > 1 ? width / static_cast<double>(rows) : 40,
               height = high * static_cast<double>(rows);
  const double left = 52, below = 34;
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" shape-rendering=\"crispEdges\" "
      "aria-label=\"{}\">",
      left + width + 8, height + below + 8, Escaped(Say(language, "Map of places")));
  for (size_t i = 0; i < placement.map.size(); ++i) {
    const size_t row = i / columns;
    const RatedPlace& rated = placement.map[i];
    const bool all = rated.worst && CauseOf(rated.score).empty();
    svg += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
        "fill=\"{}\"><title>{}</title></rect>",
        left + static_cast<double>(i % columns) * cell, 4 + height - static_cast<double>(row + 1) * high,
        cell + 0.3, high + 0.3,
        all ? Colour((*rated.worst - least) / (most - least)) : CauseColour(CauseOf(rated.score)),
        Escaped(Told(placement, rated, language)));
  }
  const auto at = [&](const PoseSettings& place) {
    const double u0 = ShownCoordinate(placement.map.front().score.place, u),
                 u1 = ShownCoordinate(placement.map.back().score.place, u),
                 v0 = ShownCoordinate(placement.map.front().score.place, v),
                 v1 = ShownCoordinate(placement.map.back().score.place, v);
    const double x = (ShownCoordinate(place, u) - u0) / (u1 - u0),
                 y = rows > 1 ? (ShownCoordinate(place, v) - v0) / (v1 - v0) : 0;
    return Vector2d(left + cell / 2 + x * (width - cell), 4 + height - high / 2 - y * (height - high));
  };
  const auto mark = [&](const PoseSettings& place, const std::string& name) {
    const Vector2d p = at(place);
    if (p.x() < left || p.x() > left + width || p.y() < 4 || p.y() > 4 + height) return;
    svg += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"5\" fill=\"none\" stroke=\"#000\" stroke-width=\"3\"/>"
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"5\" fill=\"none\" stroke=\"#fff\" stroke-width=\"1.5\"/>"
        "<text x=\"{2:.1f}\" y=\"{3:.1f}\" font-size=\"12\" "
        "style=\"fill:#fff;stroke:#000;stroke-width:3px;paint-order:stroke\">{4}</text>",
        p.x(), p.y(), p.x() + 8, p.y() < 20 ? p.y() + 14 : p.y() - 6, Escaped(name));
  };
  for (size_t i = 0; i < placement.plans.size(); ++i)
    mark(placement.plans[i].place, i == 0 ? Say(language, "job") : fmt::format("{}", i));
  const auto tick = [&](double x, double y, const char* anchor, double value) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\" text-anchor=\"{}\">{}</text>", x, y,
                       anchor, ShortestNumber(value));
  };
  const PoseSettings &first = placement.map.front().score.place, &last = placement.map.back().score.place;
  tick(left, height + 18, "start", ShownCoordinate(first, u));
  tick(left + width, height + 18, "end", ShownCoordinate(last, u));
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"12\" text-anchor=\"middle\">{}</text>",
                     left + width / 2, height + 32, CoordinateLabel(u));
  if (rows > 1) {
    tick(left - 5, height + 2, "end", ShownCoordinate(first, v));
    tick(left - 5, 14, "end", ShownCoordinate(last, v));
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"12\" text-anchor=\"end\">{}</text>",
                       left - 5, height / 2 + 8, CoordinateLabel(v));
  }
  return svg + "</svg>";
}

std::string MapLegend(const FoundPlaces& placement, Language language) {
  const auto [least, most] = ScaleOf(placement);
  std::string text = "<div class=\"legend\">";
  for (int i = 0; i < 5; ++i)
    text += fmt::format("<span><i style=\"background:{}\"></i>{}</span>", Colour(i / 4.0),
                        Escaped(Say(language, fmt::format("{:.2f}{}", least + (most - least) * i / 4.0,
                                                          i == 4 ? " and more" : ""))));
  std::vector<std::string> causes;
  for (const RatedPlace& rated : placement.map) {
    const std::string cause = CauseOf(rated.score);
    if (!cause.empty() && std::ranges::find(causes, cause) == causes.end()) causes.push_back(cause);
  }
  std::ranges::sort(causes);
  for (const std::string& cause : causes)
    text += fmt::format("<span><i style=\"background:{}\"></i>{}</span>", CauseColour(cause),
                        Escaped(Say(language, (CauseColours().contains(cause) ? "" : "touches ") + cause)));
  return text + "</div>";
}

using Point2 = bg::model::d2::point_xy<double>;

/// The outline of points seen along the coordinate that is neither u nor v.
std::vector<Vector2d> Outline(const std::vector<Vector3d>& points, const Pose& X, int u, int v) {
  bg::model::multi_point<Point2> seen;
  for (const Vector3d& point : points) {
    const Vector3d at = X * point;
    seen.emplace_back(at[u], at[v]);
  }
  bg::model::polygon<Point2> hull;
  bg::convex_hull(seen, hull);
  std::vector<Vector2d> outline;
  for (const Point2& p : hull.outer()) outline.emplace_back(p.x(), p.y());
  return outline;
}

/// Where a label may stand so that it covers none of `labels`, which gets it: higher, or lower where there is
/// no room.
Vector2d FreeLabel(const Vector2d& at, std::vector<Vector2d>& labels) {
  constexpr double kWide = 100, kHigh = 14, kTop = 11;
  const auto covers = [&](const Vector2d& label) {
    return std::ranges::any_of(labels, [&](const Vector2d& other) {
      return std::abs(label.x() - other.x()) < kWide && std::abs(label.y() - other.y()) < kHigh;
    });
  };
  Vector2d label = at;
  for (int row = 1; covers(label); ++row) {
    label.y() = at.y() - row * kHigh;
    if (label.y() < kTop || covers(label)) label.y() = at.y() + row * kHigh;
  }
  labels.push_back(label);
  return label;
}

/// The robot's base, the part where the job has it and where it is best, and the sampled points.
std::string ViewSvg(const FoundPlaces& placement, int u, int v, Language language) {
  struct Drawn {
    std::vector<Vector2d> outline, points;
    std::string name, colour;
  };
  std::vector<Drawn> all;
  const auto add = [&](const Pose& X, const std::string& name, const char* colour) {
    Drawn drawn{Outline(placement.part.empty() ? placement.sample : placement.part, X, u, v),
                {},
                Say(language, name),
                colour};
    for (const Vector3d& point : placement.sample) {
      const Vector3d at = X * point;
      drawn.points.emplace_back(at[u], at[v]);
    }
    all.push_back(std::move(drawn));
  };
  std::vector<std::pair<Vector2d, std::string>> bases;
  const auto add_base = [&](const Vector3d& at, const std::string& name) {
    bases.emplace_back(Vector2d(at[u], at[v]), Escaped(Say(language, name)));
  };
  const PoseSettings& own = placement.plans.front().place;
  const PoseSettings& best = placement.plans[placement.recommended].place;
  if (placement.robot) {
    add(placement.X_WP, "part", "#8a8f98");
    add_base(own.position, "robot, job's own");
    if (placement.recommended > 0 && !placement.split) add_base(best.position, "robot, best");
  } else {
    add(MakePose(own), "job's own", "#8a8f98");
    if (placement.recommended > 0 && !placement.split) add(MakePose(best), "best place", "#2b7de0");
    add_base(placement.base, "robot base");
  }
  if (placement.split)
    for (size_t i = 0; i < Recommended(placement).size(); ++i) {
      const PoseSettings& place = Recommended(placement)[i]->place;
      if (placement.robot)
        add_base(place.position, fmt::format("robot, station {}", i + 1));
      else
        add(MakePose(place), fmt::format("station {}", i + 1), "#2b7de0");
    }
  Eigen::AlignedBox2d box;
  for (const auto& [at, name] : bases) box.extend(at);
  for (const Drawn& drawn : all)
    for (const Vector2d& p : drawn.outline) box.extend(p);
  const double margin = 0.08 * box.sizes().maxCoeff() + 1;
  const Vector2d lower = box.min().array() - margin, upper = box.max().array() + margin;
  const double scale = 560 / std::max(upper.x() - lower.x(), upper.y() - lower.y());
  const auto to = [&](const Vector2d& p) {
    return Vector2d((p.x() - lower.x()) * scale, (upper.y() - p.y()) * scale);
  };
  std::string svg = fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">",
                                (upper.x() - lower.x()) * scale, (upper.y() - lower.y()) * scale,
                                Escaped(Say(language, "Part and robot")));
  for (const auto& [at, name] : bases) {
    const Vector2d b = to(at);
    svg += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"7\" fill=\"none\" stroke=\"currentColor\"/>"
        "<text x=\"{2:.1f}\" y=\"{3:.1f}\" font-size=\"12\">{4}</text>",
        b.x(), b.y(), b.x() + 11, b.y() + 4, name);
  }
  std::vector<Vector2d> labels;
  for (const Drawn& drawn : all) {
    std::string corners;
    Vector2d top(0, std::numeric_limits<double>::infinity());
    for (const Vector2d& p : drawn.outline) {
      const Vector2d at = to(p);
      corners += fmt::format("{:.1f},{:.1f} ", at.x(), at.y());
      if (at.y() < top.y()) top = at;
    }
    const Vector2d label = FreeLabel(
        {std::clamp(top.x(), 32.0, (upper.x() - lower.x()) * scale - 32), std::max(11.0, top.y() - 4)},
        labels);
    svg += fmt::format(
        "<polygon points=\"{0}\" fill=\"{1}\" fill-opacity=\"0.15\" stroke=\"{1}\" stroke-width=\"1.5\"/>"
        "<text x=\"{2:.1f}\" y=\"{3:.1f}\" font-size=\"12\" text-anchor=\"middle\">{4}</text>",
        corners, drawn.colour, label.x(), label.y(), Escaped(drawn.name));
    for (const Vector2d& p : drawn.points) {
      const Vector2d at = to(p);
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.4\" fill=\"{}\"/>", at.x(), at.y(),
                         drawn.colour);
    }
  }
  return svg + "</svg>";
}

}  // namespace

std::string PlacementPage(const FoundPlaces& placement, Language language) {
  const auto say = [&](const std::string& english) { return Escaped(Say(language, english)); };
  const size_t u = placement.map_coordinates[0], v = placement.map_coordinates[1];
  const bool lengths = u < 3 && v < 3 && u != v;
  const int across = lengths ? static_cast<int>(u) : 0, up = lengths ? static_cast<int>(v) : 1;
  const char* which = placement.recommended > 0 ? "best" : "job's own";
  std::string text = TablePageHead(Say(language, placement.job + ": places"), kStyle, language) + "<h1>" +
                     say(placement.job + ": where it may be placed") + "</h1>";
  const bool none = placement.recommended == 0 && !placement.split;
  text += fmt::format("<section><h2>{}</h2><p>{}</p>{}</section>", say("Planned completely"),
                      say(std::string("÷: compared with the job's own place, below 1 is stiffer.") +
                          (none ? " No place that was planned is better than the job's own." : "")),
                      PlansTable(placement, language));
  text += StationsSection(placement, language);
  text += fmt::format(
      "<div class=\"two\"><section><h2>{}</h2><p>{}</p>{}{}</section>",
      say(fmt::format("Worst {} ÷ the job's own place, by {} sampled points", placement.objective,
                      placement.own.score.total())),
      say(fmt::format(
          "Other coordinates as in the {} place. Grey: what keeps the part, or most of its points, "
          "from there.",
          which)),
      MapSvg(placement, language), MapLegend(placement, language));
  text += fmt::format("<section><h2>{}</h2><p>{}</p>{}</section></div>",
                      say(fmt::format("Part and robot, seen along {}",
                                      std::string("xyz").substr(static_cast<size_t>(3 - across - up), 1))),
                      say(placement.robot ? "In the world; dots: sampled points."
                                          : "In the frame of workpiece.pose; dots: sampled points."),
                      ViewSvg(placement, across, up, language));
  text += fmt::format(
      "<section><h2>{}</h2><p>{}</p>{}</section>", say(fmt::format("Near the {} place", which)),
      say("How well it must be met, by the sampled points."), NearbyTable(placement.sensitivity, language));
  return text + "</body>\n</html>\n";
}

}  // namespace millpose
