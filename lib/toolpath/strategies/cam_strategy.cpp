// SPDX-License-Identifier: GPL-3.0-or-later
// Strategy cam: a path that a CAM system has made.
#include "base/text.hpp"
#include "toolpath/cam/cam_import.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

struct CamStrategy final : Strategy {
  std::string file;             ///< relative to the job
  double contact_distance = 1;  ///< mm
  std::vector<RotaryAxis> rotary_axes;
  std::optional<bool> tip_programming;
  std::map<std::string, bool> kinematics_codes;  ///< "M428": X, Y, Z are the tip's from then on, or not
  CircleWay circle = CircleWay::kBoth;

  std::string Name() const override { return "cam"; }
  std::string File() const override { return file; }
  bool IsPrescribed() const override { return true; }
  std::vector<std::string> WithoutEffect() const override { return {"share"}; }
  LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const override;

 private:
  CamPath Read(const StrategyInputs& inputs) const;
};

// Cutters of the file that are not the cell's.
void TellOtherCutters(const CamPath& path, double diameter, const std::string& file,
                      std::vector<std::string>& warnings) {
  constexpr double kSameDiameter = 1e-3;  // mm
  for (const CamCutter& cutter : path.cutters)
    if (std::abs(cutter.diameter - diameter) > kSameDiameter)
      warnings.push_back(fmt::format("{}:{}: the path is for a cutter of {:.6g} mm, the cell's has {:.6g} mm",
                                     file, cutter.line, cutter.diameter, diameter));
}

std::string NotMachined(const CamHole& hole) {
  return fmt::format("{} in line {} at ({:.3f}, {:.3f}, {:.3f}) mm of the workpiece: {}", hole.cycle,
                     hole.line, hole.position.x(), hole.position.y(), hole.position.z(), hole.why);
}

CamPath CamStrategy::Read(const StrategyInputs& inputs) const {
  CamReadOptions read;
  read.chord_tolerance = inputs.options.chord_tolerance;
  std::vector<RotaryAxis> axes = rotary_axes;
  for (RotaryAxis& axis : axes) axis.direction.normalize();
  read.rotary_axes = RotaryAxes(std::move(axes));
  read.circle = circle;
  read.tip_programming = tip_programming;
  for (const auto& [code, tip] : kinematics_codes) read.kinematics_codes[std::stoi(code.substr(1))] = tip;
  return ReadCamPath(inputs.file, file, read);
}

LaidPath CamStrategy::Make(const StrategyInputs& inputs, std::stop_token) const {
  const CamPath path = Read(inputs);
  const CutterShape& cutter = inputs.options.cutter;
  CamImportOptions options;
  options.spacing = inputs.options.spacing;
  options.crease = inputs.options.crease;
  options.contact_distance = contact_distance;
  options.feed_rate = inputs.options.feed_rate;
  if (cutter.radius > 0 && cutter.corner_radius == cutter.radius) options.ball_radius = cutter.radius;
  options.budget = inputs.options.budget;
  CamImportReport report;
  LaidPath laid;
  laid.toolpath =
      ImportCamPath(path, inputs.mesh.face_count() > 0 ? &inputs.mesh : nullptr, options, &report);
  TellOtherCutters(path, 2 * cutter.radius, file, laid.warnings);
  for (const std::string& note : path.notes) laid.notes.push_back(file + ": " + note);
  for (const CamHole& hole : path.holes_left_out) laid.holes_left_out.push_back(NotMachined(hole));
  if (report.turns_on_the_spot > 0)
    laid.warnings.push_back(fmt::format("{}: the tool turns on the spot {} times; passes end there", file,
                                        report.turns_on_the_spot));
  if (report.largest_distance && *report.largest_distance > contact_distance)
    laid.warnings.push_back(
        fmt::format("{}: points lie up to {:.3f} mm from the part (median {:.3f} mm); is the "
                    "path given in the workpiece frame?",
                    file, *report.largest_distance, *report.median_distance));
  return laid;
}

yaml::Codec<RotaryAxis> RotaryAxisFields() {
  using Axis = RotaryAxis;
  using namespace yaml;
  return Section<Axis>(
      {Key<Axis>("axis", MILLPOSE_AT(letter), ChoiceOf<char>({{"A", 'A'}, {"B", 'B'}, {"C", 'C'}}),
                 "Its address in the program.")
           .Required(),
       Key<Axis>("direction", MILLPOSE_AT(direction), yaml::Direction(),
                 "Positive angles turn right-handed about it; workpiece frame, all rotary axes at 0.")
           .Required(),
       Key<Axis>("carries", MILLPOSE_AT(carries_workpiece),
                 ChoiceOf<bool>({{"tool", false}, {"workpiece", true}}), "What it turns."),
       Key<Axis>("point_mm", MILLPOSE_AT(point), yaml::Coordinates(),
                 "A point of the axis: in the workpiece frame, of one that carries the tool from its tip. "
                 "Needed where the program does not name the tip (no TRAORI, no G43.4).")});
}

// Every key is "M" with a number, and keys that hold for another format are reported when the file is read.
void CheckCodes(const yaml::Value& value, const yaml::Context& context, CamStrategy& cam) {
  for (const auto& [code, tip] : cam.kinematics_codes) {
    const auto number = code.size() > 1 && code[0] == 'M' ? ParseNumber(code.substr(1)) : std::nullopt;
    if (!number || !(*number >= 0 && *number <= 9999 && *number == std::floor(*number)))
      context.Add(value.mark, fmt::format("kinematics_codes needs codes like M428, given \"{}\"", code));
  }
}

yaml::Codec<CamStrategy> Fields() {
  using S = CamStrategy;
  using namespace yaml;
  return Section<S>(
      {Key<S>("file", MILLPOSE_AT(file), Text(), "APT CLDATA, G-code or CSV, in the workpiece frame.")
           .Required(),
       Key<S>("contact_distance_mm", MILLPOSE_AT(contact_distance), Real(kMm, Positive(1000)),
              "Points farther from the part at a pass's ends are its lead-in and lead-out."),
       Key<S>("rotary_axes", MILLPOSE_AT(rotary_axes), ListOf(RotaryAxisFields()),
              "Of the machine that G-code was written for: those that carry the tool from the "
              "bed to the tool, those that carry the workpiece from the bed to it."),
       Key<S>(
           "tip_programming", MILLPOSE_AT(tip_programming), Maybe(Flag()),
           "Of G-code: whether X, Y, Z are the tip's in the workpiece frame where the file begins (else the "
           "machine's linear axes), and what M codes of the kinematics (M128, M428 to M430) that "
           "kinematics_codes does not name stand for."),
       Key<S>("kinematics_codes", MILLPOSE_AT(kinematics_codes),
              MapOf<bool>({}, ChoiceOf<bool>({{"tip", true}, {"joints", false}})),
              "Of G-code: what X, Y, Z are from such an M code on, e.g. {M428: tip, M429: joints}."),
       Key<S>("circle", MILLPOSE_AT(circle),
              ChoiceOf<CircleWay>(
                  {{"both", CircleWay::kBoth}, {"tangent", CircleWay::kTangent}, {"axis", CircleWay::kAxis}}),
              "Of APT: what decides which way round a CIRCLE with an axis goes where the cut before and the "
              "axis's sign contradict; both: the file is refused there.")},
      CheckCodes);
}

}  // namespace

StrategyEntry CamEntry() {
  return EntryOf<CamStrategy>("cam", "Strategy cam: an imported tool path.", Fields());
}

}  // namespace millpose
