// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/paper/figure3.hpp"

#include "machine/stiffness/compliance.hpp"
#include "planning/pose/map.hpp"
#include "tests/paper/paper_data.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr int kColumns = 44, kRows = 44, kBands = 10;
constexpr double kStep = 60;  // mm
constexpr double kFirstX = 300, kFirstZ = -300;
constexpr double kScale = 0.2;  // pixels per mm
constexpr int kLeft = 70, kTop = 20;

// Ten of viridis' colours (public domain), dark to bright.
constexpr const char* kColours[kBands] = {"#440154", "#482878", "#3e4989", "#31688e", "#26828e",
                                          "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"};

/// Table 6's tool upright on a wall in front of the arm, as the poses of the paper stand.
MapRequest Request() {
  MapRequest request;
  request.arm = Chen2021Table6();
  request.lower = kTable5[0].cwiseMax(request.arm.lower);
  request.upper = kTable5[1].cwiseMin(request.arm.upper);
  request.X_FT.linear().col(2) = kToolAxis;
  request.X_FT.linear().col(0) = (Vector3d::UnitZ() - kToolAxis.z() * kToolAxis).normalized();
  request.X_FT.linear().col(1) = kToolAxis.cross(request.X_FT.linear().col(0));
  request.X_FT.translation() = kTip;
  request.origin = {kFirstX, 0, kFirstZ};
  request.u = {kStep, 0, 0};
  request.v = {0, 0, kStep};
  request.u_count = kColumns;
  request.v_count = kRows;
  request.tool_axis = request.normal = -Vector3d::UnitX();
  request.rotation_step = DegToRad(5);
  return request;
}

double X(double x) { return kLeft + kScale * (x - kFirstX + kStep / 2); }
double Y(double z) { return kTop + kScale * (kFirstZ + (kRows - 0.5) * kStep - z); }

std::string Axes() {
  std::string svg;
  const double bottom = Y(kFirstZ - kStep / 2);
  for (int x = 500; x <= 2500; x += 500)
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", X(x),
                       bottom + 16, x);
  for (int z = 0; z <= 2000; z += 500)
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", kLeft - 6, Y(z) + 4, z);
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">x of the tip, mm</text>\n",
                     X(1600), bottom + 34);
  svg += fmt::format(
      "<text x=\"16\" y=\"{0:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {0:.1f})\">"
      "z of the tip, mm</text>\n",
      Y(1000));
  return svg;
}

std::string Legend(double greatest) {
  std::string svg;
  const double left = X(kFirstX + kColumns * kStep) + 12;
  for (int band = 0; band < kBands; ++band) {
    const double y = kTop + 24.0 * (kBands - 1 - band);
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"18\" height=\"24\" fill=\"{}\"/>\n", left, y,
                       kColours[band]);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{:.3f}</text>\n", left + 24, y + 28,
                       greatest * band / kBands);
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">D, 1</text>\n", left + 24, kTop + 4.0);
  return svg;
}

}  // namespace

Figure3 DrawFigure3() {
  const MapRequest request = Request();
  const std::vector<MapPoint> points = DrawMap(request);
  Figure3 figure;
  figure.total = points.size();
  for (const MapPoint& at : points) {
    if (!at.reached) continue;
    ++figure.reached;
    if (at.value <= figure.greatest) continue;
    figure.greatest = at.value;
    figure.in_mm = Dexterity(Jacobian(request.arm, at.q, kTip), 1);
  }
  figure.yellow_from = 0.7 * figure.greatest;
  const double width = X(kFirstX + kColumns * kStep) + 90, height = Y(kFirstZ - kStep / 2) + 44;
  figure.svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" "
      "font-family=\"sans-serif\" "
      "font-size=\"11\">\n<!-- SPDX-License-Identifier: GPL-3.0-or-later; written by tests/paper/figure3.cpp "
      "-->\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height);
  for (const MapPoint& at : points) {
    if (!at.reached) continue;
    const int band = std::min(kBands - 1, static_cast<int>(kBands * at.value / figure.greatest));
    figure.svg +=
        fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
                    X(at.point.x() - kStep / 2), Y(at.point.z() + kStep / 2), kScale * kStep, kScale * kStep,
                    kColours[band]);
  }
  figure.svg += Axes() + Legend(figure.greatest);
  const Vector3d tip = ForwardFlange(request.arm, kTable6[0]) * kTip;
  figure.svg += fmt::format(
      "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"5\" fill=\"none\" stroke=\"#d00\" stroke-width=\"2\"/>\n"
      "<text x=\"{2:.1f}\" y=\"{1:.1f}\" fill=\"#d00\">Table 6</text>\n</svg>\n",
      X(tip.x()), Y(tip.z()), X(tip.x()) + 8);
  return figure;
}

}  // namespace millpose
