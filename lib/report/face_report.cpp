// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/face_report.hpp"

#include <fmt/format.h>

#include "base/units.hpp"
#include "report/face_json.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFaceMicrometres = 1000;

/// µm; what rounding leaves is 0.
std::string ShownMicrometres(const std::optional<double>& millimetres) {
  constexpr double kRounding = 1e-6;  // µm
  if (!millimetres) return "-";
  const double shown = kFaceMicrometres * *millimetres;
  return fmt::format("{:.4g}", std::abs(shown) < kRounding ? 0 : shown);
}

std::string FaceRow(const char* name, const FaceFigures& face) {
  const std::optional<double> figures[] = {face.heights.level,
                                           face.heights.low,
                                           face.heights.high,
                                           face.flatness,
                                           face.minimum_zone,
                                           face.added.high - face.added.low,
                                           face.within ? std::optional(face.within->range) : std::nullopt,
                                           face.step ? std::optional(face.step->height) : std::nullopt};
  std::string row = fmt::format("{:<22}", name);
  for (const std::optional<double>& figure : figures) row += fmt::format("{:>11}", ShownMicrometres(figure));
  return row + '\n';
}

std::string FaceRows(const FaceStudy& study) {
  std::string text = FaceRow("tool without error", study.flawless.figures);
  if (study.by_force) text += FaceRow("force alone", *study.by_force);
  if (study.by_lost) text += FaceRow("lost motion alone", *study.by_lost);
  if (study.by_geometry) text += FaceRow("geometry alone", *study.by_geometry);
  text += FaceRow("expected", study.expected.figures);
  if (const size_t standing = study.expected.figures.standing; standing > 0)
    text += fmt::format("  {} places are left standing as high as the stock: passes do not quite meet\n",
                        standing);
  if (!study.drawn) return text;
  const DrawnFaces& drawn = *study.drawn;
  const auto interval = [](const DrawnInterval& of) {
    return fmt::format("{:.4g} to {:.4g}", kFaceMicrometres * of.low, kFaceMicrometres * of.high);
  };
  text += fmt::format("  5 to 95 % of {} draws within what is stated, on {} places: level {}, added {}",
                      drawn.count, drawn.rays, interval(drawn.level), interval(drawn.added));
  if (drawn.flatness) text += ", flatness " + interval(*drawn.flatness);
  return text + '\n';
}

std::string StatedText(const StatedErrors& stated) {
  std::string text;
  if (stated.force)
    text += fmt::format("mean cutting force, known to {:.4g} % and {:.4g} deg; ", 100 * stated.force_share,
                        RadToDeg(stated.force_angle));
  if (stated.lost) text += "lost motion of the gears; ";
  if (stated.tip > 0 || stated.lean > 0)
    text += fmt::format("tool known to {:.4g} mm and {:.4g} deg; ", stated.tip, RadToDeg(stated.lean));
  if (stated.geometry) text += "geometry of this arm, the part measured with it; ";
  if (stated.gears) text += "periodic error of the gears, drawn; ";
  if (stated.part) text += "where the part was registered, drawn; ";
  return text.empty() ? "nothing" : text.substr(0, text.size() - 2);
}

}  // namespace

std::vector<std::string> NotInFace(const StatedErrors& stated) {
  std::vector<std::string> missing;
  if (!stated.gears) missing.push_back("gear error");
  if (!stated.geometry) missing.push_back("geometry of the arm");
  if (!stated.part) missing.push_back("registration of the part");
  missing.insert(missing.end(), {"temperature", "dynamics", "wear of the tool"});
  return missing;
}

std::string FaceText(const FaceReport& report) {
  std::string text = fmt::format(
      "face of {}: heights along the normal at {} places {:.4g} mm apart, um\n\n{:<22}{:>11}{:>11}{:>11}"
      "{:>11}{:>11}{:>11}{:>11}{:>11}\n",
      report.job, report.plan.expected.figures.rays, report.rays.spacing, "", "level", "lowest", "highest",
      "flatness", "zone", "added", "in pass", "step");
  text += FaceRows(report.plan);
  if (report.fixed)
    text += fmt::format("\nat a fixed rotation of {:.4g} deg\n", RadToDeg(*report.rotation)) +
            FaceRows(*report.fixed);
  if (!report.fixed_in_the_way.empty())
    text += "\nno fixed rotation beside it: " + report.fixed_in_the_way + '\n';
  text += fmt::format("\nstated: {}\nnot in it: {}\n", StatedText(report.stated),
                      fmt::join(NotInFace(report.stated), ", "));
  if (!report.rays.plane) text += "the region is no plane: flatness does not apply\n";
  return text;
}

std::string FaceJson(const FaceReport& report) {
  return FaceReportJson(report).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace millpose
