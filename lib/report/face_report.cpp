// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/face_report.hpp"

#include <fmt/format.h>

#include "base/units.hpp"
#include "report/face_json.hpp"
#include "report/words/word_table.hpp"

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

constexpr size_t kRowName = 22, kRowFigure = 11;  // columns of a terminal

/// A text in its columns, to the right of them or to the left.
std::string InColumns(const std::string& text, size_t columns, bool right) {
  const std::string blanks(columns - std::min(columns, ColumnsOf(text)), ' ');
  return right ? blanks + text : text + blanks;
}

/// Writes the rows of the table and the lines under them.
class FaceWriter {
 public:
  explicit FaceWriter(Language language) : language_(language) {}

  std::string Said(const std::string& english) const { return Say(language_, english); }

  std::string Head() const {
    std::string row(kRowName, ' ');
    for (const char* column :
         {"level", "lowest", "highest", "flatness", "zone", "added", "in pass", "at steps"})
      row += InColumns(Said(column), kRowFigure, true);
    return row + '\n';
  }

  std::string Rows(const FaceStudy& study) const {
    std::string text = Row("tool without error", study.flawless.figures);
    if (study.by_force) text += Row("force alone", *study.by_force);
    if (study.by_lost) text += Row("lost motion alone", *study.by_lost);
    if (study.by_geometry) text += Row("geometry alone", *study.by_geometry);
    text += Row("expected", study.expected.figures);
    if (const size_t standing = study.expected.figures.standing; standing > 0)
      text += "  " +
              Said(fmt::format("{} places are left standing as high as the stock: passes do not quite meet",
                               standing)) +
              '\n';
    return study.drawn ? text + "  " + Said(DrawnText(*study.drawn)) + '\n' : text;
  }

 private:
  std::string Row(const char* name, const FaceFigures& face) const {
    const std::optional<double> figures[] = {face.heights.level,
                                             face.heights.low,
                                             face.heights.high,
                                             face.flatness,
                                             face.minimum_zone,
                                             face.added.high - face.added.low,
                                             face.within ? std::optional(face.within->range) : std::nullopt,
                                             face.step ? std::optional(face.step->height) : std::nullopt};
    std::string row = InColumns(Said(name), kRowName, false);
    for (const std::optional<double>& figure : figures)
      row += InColumns(ShownMicrometres(figure), kRowFigure, true);
    return row + '\n';
  }

  static std::string DrawnText(const DrawnFaces& drawn) {
    const auto interval = [](const DrawnInterval& of) {
      return fmt::format("{:.4g} to {:.4g}", kFaceMicrometres * of.low, kFaceMicrometres * of.high);
    };
    std::string text =
        fmt::format("5 to 95 % of {} draws within what is stated, on {} places: level {}, added {}",
                    drawn.count, drawn.rays, interval(drawn.level), interval(drawn.added));
    if (drawn.flatness) text += ", flatness " + interval(*drawn.flatness);
    return text;
  }

  Language language_;
};

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

std::string FaceText(const FaceReport& report, Language language) {
  const FaceWriter writer(language);
  std::string text =
      writer.Said(fmt::format("face of {}: heights along the normal at {} places {:.4g} mm apart, um",
                              report.job, report.plan.expected.figures.rays, report.rays.spacing)) +
      "\n\n" + writer.Head() + writer.Rows(report.plan);
  if (report.fixed)
    text += '\n' + writer.Said(fmt::format("at a fixed rotation of {:.4g} deg", RadToDeg(*report.rotation))) +
            '\n' + writer.Rows(*report.fixed);
  if (!report.fixed_in_the_way.empty())
    text += '\n' + writer.Said("no fixed rotation beside it: " + report.fixed_in_the_way) + '\n';
  text += '\n' + writer.Said("stated: " + StatedText(report.stated)) + '\n' +
          writer.Said(fmt::format("not in it: {}", fmt::join(NotInFace(report.stated), ", "))) + '\n';
  if (!report.rays.plane) text += writer.Said("the region is no plane: flatness does not apply") + '\n';
  return text;
}

std::string FaceJson(const FaceReport& report) {
  return FaceReportJson(report).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace millpose
