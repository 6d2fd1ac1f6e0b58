// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/path_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "report/page/escaped.hpp"

namespace millpose {
namespace {

constexpr double kChartWidth = 720, kChartLeft = 52, kChartRight = 12, kChartTop = 8,
                 kChartBelow = 26;  // px
constexpr size_t kMostTicks = 400;  // of skipped points

/// Where a chart of a height puts values.
struct ChartAxes {
  double height = 0, length = 1, top = 1;
  double X(double way) const { return kChartLeft + way / length * (kChartWidth - kChartLeft - kChartRight); }
  double Y(double value) const {
    return height - kChartBelow - value / top * (height - kChartTop - kChartBelow);
  }
};

struct Peak {
  double x = 0, value = 0;
  bool begins = false;  // points without a figure lie before it
};

/// The largest value of each pixel column that has one.
std::vector<Peak> PeaksOf(const PathCurves& curves, const PathSeries& series, const ChartAxes& axes) {
  std::vector<Peak> peaks;
  bool begins = true;
  for (size_t i = 0; i < curves.way.size(); ++i) {
    if (std::isnan(series.values[i])) {
      begins = true;
      continue;
    }
    const double x = std::round(axes.X(curves.way[i]));
    if (!peaks.empty() && peaks.back().x == x)
      peaks.back().value = std::max(peaks.back().value, series.values[i]);
    else
      peaks.push_back({x, series.values[i], begins});
    begins = false;
  }
  return peaks;
}

std::string ChartText(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor,
                     Escaped(text));
}

std::string Grid(const PathCurves& curves, const ChartAxes& axes) {
  std::string svg;
  const double step = RoundStep(axes.top, 4);
  for (int k = 0; k * step <= axes.top * (1 + 1e-9); ++k) {
    const double y = axes.Y(k * step);
    svg += fmt::format("<path d=\"M{:.1f},{:.1f}H{:.1f}\" stroke=\"currentColor\" stroke-opacity=\"{}\"/>",
                       kChartLeft, y, kChartWidth - kChartRight, k == 0 ? ".8" : ".18");
    svg += ChartText(kChartLeft - 5, y + 3.5, "end", fmt::format("{:.6g}", k * step));
  }
  // A path of many metres in metres, a shorter one in millimetres.
  const bool metres = axes.length >= 10'000;
  const double unit = metres ? 1000 : 1, along = RoundStep(axes.length / unit, 8);
  for (int k = 0; k * along * unit <= axes.length * (1 + 1e-9); ++k) {
    const double x = axes.X(k * along * unit);
    if (x > kChartWidth - kChartRight - 60 && k > 0) continue;  // the unit stands there
    svg += ChartText(x, axes.height - kChartBelow + 13, "middle", fmt::format("{:.6g}", k * along));
  }
  svg += ChartText(kChartWidth - kChartRight, axes.height - kChartBelow + 13, "end",
                   fmt::format("{:.4g} {}", axes.length / unit, metres ? "m" : "mm"));
  return svg + ChartText(4, axes.Y(axes.top) + 3.5, "start", curves.unit);
}

std::string Marks(const PathCurves& curves, const ChartAxes& axes) {
  std::string svg;
  for (const auto& [way, number] : curves.parts) {
    const double x = axes.X(way);
    svg += fmt::format(
        "<path d=\"M{:.1f},{:.1f}V{:.1f}\" stroke=\"currentColor\" stroke-opacity=\".5\" "
        "stroke-dasharray=\"3 3\"/>",
        x, kChartTop, axes.height - kChartBelow);
    svg += ChartText(x + 3, kChartTop + 8, "start", number);
  }
  std::optional<double> last;
  size_t ticks = 0;
  for (const double way : curves.left_out) {
    const double x = std::round(axes.X(way));
    if (last == x || ++ticks > kMostTicks) continue;
    last = x;
    svg += fmt::format("<path class=\"skipped\" d=\"M{0:.0f},{1:.1f}V{2:.1f}\" stroke=\"#b3261e\"/>", x,
                       axes.height - kChartBelow - 5, axes.height - kChartBelow + 3);
  }
  return svg;
}

std::string Curve(const std::vector<Peak>& peaks, const std::string& colour, const ChartAxes& axes) {
  if (peaks.empty()) return {};
  std::string d;
  for (const Peak& peak : peaks)
    d += fmt::format("{}{:.0f},{:.1f}{}", peak.begins ? "M" : "L", peak.x, axes.Y(peak.value),
                     peak.begins ? "h0" : "");  // a point by itself is a dot
  const Peak& worst = *std::ranges::max_element(peaks, {}, &Peak::value);
  return fmt::format(
      "<path class=\"course\" d=\"{0}\" fill=\"none\" stroke=\"{1}\" stroke-width=\"1.3\" "
      "stroke-linejoin=\"round\" stroke-linecap=\"round\"/><circle cx=\"{2:.0f}\" cy=\"{3:.1f}\" r=\"3\" "
      "fill=\"{1}\"/>",
      d, colour, worst.x, axes.Y(worst.value));
}

}  // namespace

double RoundStep(double range, int most) {
  double step = 1;
  while (step < range / most) step *= 10;
  while (step / 10 >= range / most) step /= 10;
  for (const double share : {5.0, 2.0})
    if (step / share >= range / most) return step / share;
  return step;
}

std::string CurvesSvg(const PathCurves& curves, double height, const std::string& title) {
  ChartAxes axes{height, curves.way.empty() ? 1 : std::max(curves.way.back(), 1e-3), 0};
  std::vector<std::vector<Peak>> all;
  for (const PathSeries& series : curves.series) {
    all.push_back(PeaksOf(curves, series, axes));
    for (const Peak& peak : all.back()) axes.top = std::max(axes.top, peak.value);
  }
  if (axes.top <= 0) axes.top = 1;
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" role=\"img\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"10\" fill=\"currentColor\">",
      kChartWidth, height);
  svg += fmt::format("<title>{}</title>", Escaped(title.empty() ? curves.title : title));
  svg += Grid(curves, axes) + Marks(curves, axes);
  for (size_t i = 0; i < all.size(); ++i) svg += Curve(all[i], curves.series[i].colour, axes);
  return svg + "</svg>";
}

}  // namespace millpose
