// SPDX-License-Identifier: GPL-3.0-or-later
// Strategy cam: a path that a CAM system has made.
#include "base/text.hpp"
#include "toolpath/cam/cam_import.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

/// Whose speed and sense of the spindle hold.
enum class SpindleFrom : uint8_t { kFile, kCell };

struct CamStrategy final : Strategy {
  std::string file;             ///< relative to the job
  double contact_distance = 1;  ///< mm
  std::vector<RotaryAxis> rotary_axes;
  std::optional<bool> tip_programming;
  std::map<std::string, bool> kinematics_codes;  ///< "M428": X, Y, Z are the tip's from then on, or not
  CircleSense circle = CircleSense::kBoth;
  std::optional<CamSender> sender;
  std::optional<double> unit;  ///< mm
  std::optional<CamFrame> frame;
  std::optional<CyclePoint> cycle_point;
  std::map<std::string, Eigen::Vector3d> offsets;  ///< "G54": where its zero lies in the workpiece, mm
  std::optional<int> section;                      ///< of the file's sections, from 1
  SpindleFrom spindle = SpindleFrom::kFile;

  std::string Name() const override { return "cam"; }
  std::string File() const override { return file; }
  bool IsPrescribed() const override { return true; }
  std::vector<std::string> WithoutEffect() const override { return {"share"}; }
  std::vector<CamSection> Sections(const StrategyInputs& inputs) const override {
    return Read(inputs).source.sections;
  }
  LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const override;

 private:
  CamPath Read(const StrategyInputs& inputs) const;
  void CheckKeysUsed(const CamPath& path) const;
  CamPath OneSection(const CamPath& path) const;
  std::optional<double> SpindleOf(const CamPath& path) const;
};

// A cutter of the section that is not the cell's.
void TellOtherCutter(const CamPath& path, double diameter, const std::string& file,
                     std::vector<std::string>& warnings) {
  constexpr double kSameDiameter = 1e-3;  // mm
  for (const CamSection& section : path.source.sections)
    if (section.diameter && std::abs(*section.diameter - diameter) > kSameDiameter)
      warnings.push_back(fmt::format("{}:{}: the path is for a cutter of {:.6g} mm, the cell's has {:.6g} mm",
                                     file, section.first_line, *section.diameter, diameter));
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
  read.sender = sender;
  read.unit = unit;
  read.frame = frame;
  read.cycle_point = cycle_point;
  read.offsets = offsets;
  for (const auto& [code, tip] : kinematics_codes) read.kinematics_codes[std::stoi(code.substr(1))] = tip;
  return ReadCamPath(inputs.file, file, read);
}

// A key that decided nothing is one that was meant for another file.
void CamStrategy::CheckKeysUsed(const CamPath& path) const {
  std::vector<Problem> problems;
  const auto check = [&](bool given, const std::string& key, std::string_view why) {
    if (given && !path.keys_used.contains(key))
      problems.push_back({{file}, fmt::format("toolpath.cam.{} has no effect: {}", key, why)});
  };
  check(unit.has_value(), "unit", "the file states its unit itself");
  check(frame.has_value(), "frame", "the file states no frame that could be taken in another way");
  check(cycle_point.has_value(), "cycle_point",
        "the file has no cycle by places whose point could be either");
  for (const auto& [name, origin] : offsets) check(true, "offsets_mm." + name, "nothing is cut under it");
  if (!problems.empty()) throw InputError(std::move(problems));
}

// A job mills with one tool at one speed: of a file with several sections it names one.
CamPath CamStrategy::OneSection(const CamPath& path) const {
  const std::vector<CamSection>& sections = path.source.sections;
  if (section && (*section < 1 || *section > static_cast<int>(sections.size())))
    throw InputError({file}, fmt::format("toolpath.cam.section: given {}, the file has {}", *section,
                                         sections.size() == 1 ? "one section"
                                                              : fmt::format("{} sections", sections.size())));
  if (section) return TakeSection(path, static_cast<size_t>(*section) - 1);
  if (sections.size() < 2) return path;
  constexpr size_t kShown = 50;
  std::string list;
  for (size_t i = 0; i < std::min(kShown, sections.size()); ++i)
    list += fmt::format("\n  section {}: {}, lines {} to {}", i + 1, sections[i].ToText(),
                        sections[i].first_line, sections[i].last_line);
  if (sections.size() > kShown) list += fmt::format("\n  and {} further", sections.size() - kShown);
  throw InputError(
      {file, sections[1].first_line},
      fmt::format("the path has sections for several tools or spindle speeds, and a job mills with "
                  "one: make each an operation (operations:) with its tool and "
                  "toolpath.cam.section: 1, 2, …, as `millpose check JOB --split FILE` does{}",
                  list));
}

// The file's speed; its sense must be the one that programs switch on.
std::optional<double> CamStrategy::SpindleOf(const CamPath& path) const {
  if (spindle == SpindleFrom::kCell || path.source.sections.empty()) return std::nullopt;
  const CamSection& cuts = path.source.sections.front();
  if (cuts.sense == SpindleSense::kCounterClockwise)
    throw InputError(
        {file, cuts.first_line},
        fmt::format("the file turns the spindle counter-clockwise{}, and programs switch it on "
                    "clockwise: state toolpath.cam.spindle: cell when process.spindle_rpm and the "
                    "sense that the cell's texts switch on are right for this cutter",
                    cuts.speed ? fmt::format(" (at {:.6g}/min)", 60 * *cuts.speed) : ""));
  return cuts.speed;
}

LaidPath CamStrategy::Make(const StrategyInputs& inputs, std::stop_token) const {
  const CamPath whole = Read(inputs);
  CheckKeysUsed(whole);
  const CamPath path = OneSection(whole);
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
  laid.spindle_speed = SpindleOf(path);
  laid.source = path.source;
  laid.notes.push_back(file + ": read as " + path.source.ToText());
  laid.toolpath =
      ImportCamPath(path, inputs.mesh.face_count() > 0 ? &inputs.mesh : nullptr, options, &report);
  TellOtherCutter(path, 2 * cutter.radius, file, laid.warnings);
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

yaml::Codec<CamSender> SenderCodec() {
  std::vector<std::pair<std::string, CamSender>> choices;
  for (const CamSender sender : StatableSenders()) choices.emplace_back(RulesOf(sender).key, sender);
  return yaml::ChoiceOf<CamSender>(std::move(choices));
}

yaml::Codec<CamStrategy> CamFields() {
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
              ChoiceOf<CircleSense>({{"both", CircleSense::kBoth},
                                     {"tangent", CircleSense::kTangent},
                                     {"axis", CircleSense::kAxis}}),
              "Of APT: what decides which way round a CIRCLE with an axis goes where the cut before and the "
              "axis's sign contradict; both: the file is refused there."),
       Key<S>("sender", MILLPOSE_AT(sender), Maybe(SenderCodec()),
              "Who wrote the file, where it does not tell or tells wrong: decides what words mean that "
              "senders use "
              "differently (docs/cam-import.md)."),
       Key<S>("unit", MILLPOSE_AT(unit), Maybe(ChoiceOf<double>({{"mm", 1.0}, {"inch", 25.4}})),
              "Of APT and G-code: the length unit where the file states none."),
       Key<S>("frame", MILLPOSE_AT(frame),
              Maybe(ChoiceOf<CamFrame>({{"stated", CamFrame::kStated}, {"as_given", CamFrame::kAsGiven}})),
              "Of APT: whether systems that comments state (CATIA0, CSYS) place the points in the workpiece "
              "frame, "
              "or they stand there as they are written, which says the same of ORIGIN and TRANS. Default: a "
              "CATIA0 that turns no axes does; others are refused."),
       Key<S>("cycle_point", MILLPOSE_AT(cycle_point),
              Maybe(ChoiceOf<CyclePoint>({{"top", CyclePoint::kTop}, {"bottom", CyclePoint::kBottom}})),
              "Of APT: which end of a hole the point under a cycle by places (CYCLE/DRILL,12,MMPM,120,5) is, "
              "where "
              "the file may mean either."),
       Key<S>(
           "offsets_mm", MILLPOSE_AT(offsets), MapOf<Eigen::Vector3d>({}, Coordinates()),
           "Of G-code: where the zero of each zero offset lies in the workpiece frame, e.g. {G54: [0, 0, 0], "
           "G55: [250, 0, 0], G54.1 P2: [0, 400, 0]}; axes parallel to its own."),
       Key<S>("section", MILLPOSE_AT(section), Maybe(Integer(1, 1'000'000)),
              "Of a file for several tools or speeds: which of its sections is milled, as check lists them."),
       Key<S>(
           "spindle", MILLPOSE_AT(spindle),
           ChoiceOf<SpindleFrom>({{"file", SpindleFrom::kFile}, {"cell", SpindleFrom::kCell}}),
           "Whose speed and sense hold: the file's where it states them (counter-clockwise is refused), or "
           "process.spindle_rpm and the sense that the cell's texts switch on.")},
      CheckCodes);
}

}  // namespace

StrategyEntry CamEntry() {
  return EntryOf<CamStrategy>("cam", "Strategy cam: an imported tool path.", CamFields());
}

}  // namespace millpose
