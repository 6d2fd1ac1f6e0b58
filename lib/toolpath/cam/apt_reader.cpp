// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "base/text.hpp"
#include "toolpath/cam/apt_arcs.hpp"
#include "toolpath/cam/apt_unit.hpp"
#include "toolpath/cam/apt_words.hpp"
#include "toolpath/cam/machine_zeros.hpp"

namespace millpose {
namespace {

class AptReader {
 public:
  AptReader(std::string_view bytes, const std::string& name, const CamReadOptions& options)
      : scanner_(bytes, name),
        name_(name),
        options_(options),
        recognised_(options.sender ? Recognised{*options.sender, ""} : RecogniseSender(bytes, false)),
        rules_(RulesOf(recognised_.sender)),
        motion_(options, rules_, sections_, path_),
        comments_(options),
        unit_(options),
        zeros_(options) {
    system_.unit = options.unit.value_or(1);
  }

  CamPath Read() {
    AptStatement statement;
    try {
      while (scanner_.Next(statement)) {
        TakeComments();
        unit_.Look(statement);
        Take(statement);
      }
      EndNurbs();
      motion_.CheckEnd();
      if (tally_.empty()) unit_.Check(name_);
    } catch (const InputError& error) {
      tally_.RefuseUnknown(error.problems());
    }
    tally_.RefuseUnknown({});
    if (path_.points.empty() && path_.holes_left_out.empty())
      throw InputError({name_}, "the file holds no GOTO");
    CheckReach(path_, name_);
    AddNotes();
    AddSource();
    return std::move(path_);
  }

 private:
  void TakeComments() {
    for (const AptWord& comment : scanner_.comments()) TakeCutterComment(comment);
    if (const auto frame = comments_.Take(scanner_.comments())) {
      EndNurbs();
      system_.TakeFrame(*frame);
      SetFrameName(fmt::format("{} in line {}{}", frame->name, frame->place.line,
                               system_.IsMoved() ? "" : " (identity)"));
    }
  }

  // Creo: "$$-> CUTTER / 8.0".
  void TakeCutterComment(const AptWord& comment) {
    const size_t slash = comment.text.find('/');
    if (!comment.text.starts_with("$$->") || slash == std::string::npos) return;
    std::string_view word = std::string_view(comment.text).substr(4, slash - 4);
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    std::string value = comment.text.substr(slash + 1);
    std::erase(value, ' ');
    const auto number = ParseNumber(value);
    if (word == "CUTTER" && number && *number > 0) AddCutter(*number, 0, comment.place.line);
  }

  // What a system leaves of the axis: it stands along the new z until it is given.
  void SetFrameName(std::string name) {
    motion_.SetAxis(system_.rotation.col(2));
    leaned_ = stale_ = false;
    frame_name_ = std::move(name);
    if (system_.IsMoved() && moved_out_of_.empty()) moved_out_of_ = frame_name_;
  }

  void Take(const AptStatement& statement) {
    const std::string& major = statement.major.text;
    if (AptNurbs::IsPart(major)) {
      if (!nurbs_) throw InputError(statement.major.place, major + " without a NURBS before it");
      return nurbs_->Add(statement);
    }
    const std::string word = FirstWord(statement.major);
    const AptMeaning meaning = MeaningOf(statement);
    if (meaning == AptMeaning::kUnknown) return tally_.AddUnknown(word, statement.major.place);
    if (meaning == AptMeaning::kHarmless) {
      CheckHarmless(statement);
      if (word == "TOOL PATH") BeginOperation(statement);
      return tally_.CountHarmless(word);
    }
    EndNurbs();
    if (meaning == AptMeaning::kMotion) return TakeMotion(statement);
    if (meaning == AptMeaning::kState) return TakeState(statement);
    if (meaning == AptMeaning::kSurfaceMotion) return DriveMotion(statement);
    Leave(statement);
  }

  void TakeMotion(const AptStatement& statement) {
    const std::string& major = statement.major.text;
    if (major == "GOTO") {
      Goto(statement);
    } else if (major == "FROM") {
      motion_.SetRapid();
      Goto(statement);
    } else if (major == "GODLTA") {
      GoDelta(statement);
    } else if (major == "RAPID") {
      motion_.SetRapid();
    } else if (major == "CIRCLE" || major == "MOVARC") {
      motion_.SetCircle(ReadCircle(statement, system_));
    } else if (major == "INDIRV") {
      motion_.SetTangent(system_.Direction(Numbers(statement, 3, 3), 0, statement));
    } else if (major == "NURBS") {
      nurbs_.emplace(statement);
    } else {
      Cycle(statement);
    }
  }

  void DriveMotion(const AptStatement& statement) {
    const auto [arc, end] = ReadDriveMotion(statement, system_);
    motion_.SetCircle(arc);
    motion_.MoveTo(end, motion_.axis(), arc.place);
  }

  void TakeState(const AptStatement& statement) {
    const std::string& major = statement.major.text;
    if (major == "FEDRAT") {
      if (!feed_.Take(statement, system_.unit)) motion_.SetRapid();
    } else if (major == "SPINDL") {
      const AptSpindle spindle =
          feed_.TakeSpindle(statement, path_.cutters.empty() ? 0 : path_.cutters.back().diameter);
      if (spindle.speed) sections_.SetSpeed(spindle.speed);
      if (spindle.sense != SpindleSense::kNotStated) sections_.SetSense(spindle.sense);
    } else if (major == "CUTTER" || major == "TLDATA") {
      Cutter(statement);
    } else if (major == "TLAXIS") {
      motion_.SetAxis(system_.Direction(Numbers(statement, 3, 3), 0, statement));
      leaned_ = stale_ = false;
    } else if (major == "MSYS") {
      system_.TakeMsys(statement);
      SetFrameName(fmt::format("MSYS in line {}{}", statement.major.place.line,
                               system_.IsMoved() ? "" : " (identity)"));
    } else if (major == "UNITS" || major == "UNIT") {
      Units(statement);
    } else if (major == "ORIGIN" || major == "TRANS") {
      zeros_.Take(major, Numbers(statement, 1, 6), statement.major.place, motion_.HasPoint());
    } else {  // LOADTL, TOOLNO, TURRET, LOAD/TOOL
      Tool(statement);
    }
    motion_.SetFeed(feed_.Rate());
  }

  // What came before the first UNITS, and is no point, is in them too.
  void Units(const AptStatement& statement) {
    const double before = system_.unit;
    system_.TakeUnits(statement);
    if (!units_stated_ && !motion_.HasPoint() && system_.unit != before) {
      system_.origin *= system_.unit / before;
      for (CamCutter& cutter : path_.cutters) {
        cutter.diameter *= system_.unit / before;
        cutter.corner_radius *= system_.unit / before;
        sections_.SetCutter(cutter.diameter, cutter.corner_radius);
      }
    }
    units_stated_ = true;
    unit_.SetStated(statement.major.place, system_.unit);
  }

  // The number of "LOADTL/1,…", "LOAD/TOOL,1,…", "TURRET/1".
  void Tool(const AptStatement& statement) {
    motion_.SetFresh();
    ++tools_;
    for (const AptWord& word : statement.minors)
      if (const auto number = ParseNumber(word.text)) return sections_.NameTool(ShortestNumber(*number));
    if (!statement.minors.empty()) sections_.NameTool(statement.minors.back().text.substr(0, 40));
  }

  // "TOOL PATH/NAME,TOOL,TOOL NAME" of NX: a new operation begins, and says its own system.
  void BeginOperation(const AptStatement& statement) {
    motion_.SetFresh();
    for (size_t i = 0; i + 1 < statement.minors.size(); ++i)
      if (statement.minors[i].text == "TOOL")
        sections_.NameOperationTool(statement.minors[i + 1].text.substr(0, 40));
    stale_ = motion_.HasPoint() && (leaned_ || system_.IsMoved());
  }

  std::string WhyAsked() const {
    if (rules_.sender != CamSender::kPlain)
      return fmt::format("which one {} means is not known", rules_.name);
    return "who wrote the file is not recognised" +
           (recognised_.conflict.empty() ? "" : " (marks of " + recognised_.conflict + ")");
  }

  // The axis of a point that gives none.
  Eigen::Vector3d AxisOfThree(const AptStatement& statement) {
    Eigen::Vector3d up = system_.rotation.col(2);
    if (stale_)
      throw InputError(
          statement.major.place,
          "the operation states neither MSYS nor the tool axis, and the one before it had its own");
    if (leaned_ && rules_.three_numbers == ThreeNumbers::kAsked && !motion_.axis().isApprox(up, 1e-9))
      throw InputError(
          statement.major.place,
          fmt::format(
              "three numbers behind a leaning tool: the axis stays, or the tool stands along +z, and {}: "
              "state whose way this file follows, toolpath.cam.sender: nx or catia (it stays), creo or "
              "autodesk (+z)",
              WhyAsked()));
    three_ = true;
    if (leaned_ && rules_.three_numbers == ThreeNumbers::kUp) return up;
    return motion_.axis();
  }

  void EndNurbs() {
    if (!nurbs_) return;
    std::vector<Eigen::Vector3d> control;
    for (const Eigen::Vector3d& p : nurbs_->Check()) control.push_back(system_.Placed(p));
    motion_.Follow(*nurbs_, control);
    nurbs_.reset();
  }

  void Cycle(const AptStatement& statement) {
    const std::string kind = statement.minors.empty() ? "" : statement.minors[0].text;
    if (kind == "OFF" || kind == "NOMORE") {
      motion_.SetCycle(std::nullopt);
    } else if (kind == "ON") {
      if (!last_cycle_) throw InputError(statement.major.place, "CYCLE/ON without a cycle before it");
      motion_.SetCycle(last_cycle_);
    } else {
      last_cycle_ = ReadCycle(statement, feed_, system_.unit);
      motion_.SetCycle(last_cycle_);
    }
  }

  // GOHOME may name the place; else only the machine knows it.
  void Leave(const AptStatement& statement) {
    if (statement.major.text == "GOHOME" && !statement.minors.empty()) {
      motion_.SetRapid();
      return Goto(statement);
    }
    motion_.SetFresh();
    tally_.CountHarmless(FirstWord(statement.major));
  }

  // CUTTER/d[,r] and NX's TLDATA/MILL,d,r,length,….
  void Cutter(const AptStatement& statement) {
    std::vector<double> numbers;
    for (const AptWord& word : statement.minors)
      if (const auto number = ParseNumber(word.text)) numbers.push_back(system_.unit * *number);
    if (numbers.empty() || !(numbers[0] > 0)) return;
    AddCutter(numbers[0] / system_.unit, numbers.size() > 1 ? numbers[1] / system_.unit : 0,
              statement.major.place.line);
  }

  // In file units.
  void AddCutter(double diameter, double corner_radius, int line) {
    unit_.TakeCutter(diameter);
    path_.cutters.push_back({system_.unit * diameter, system_.unit * corner_radius, line});
    sections_.SetCutter(path_.cutters.back().diameter, path_.cutters.back().corner_radius);
  }

  void Goto(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 3, 6);
    if (v.size() != 3 && v.size() != 6)
      throw InputError(statement.major.place,
                       fmt::format("{} needs 3 or 6 numbers, found {}", statement.major.text, v.size()));
    const Eigen::Vector3d axis = v.size() == 6 ? system_.Direction(v, 3, statement) : AxisOfThree(statement);
    if (v.size() == 6) GiveAxis();
    motion_.MoveTo(system_.Placed({v[0], v[1], v[2]}), axis, statement.major.place);
  }

  // The axis follows from six numbers: what three mean then is each sender's.
  void GiveAxis() {
    leaned_ = true;
    stale_ = false;
  }

  void GoDelta(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 1, 6);
    if (!motion_.HasPoint() || motion_.in_cycle())
      throw InputError(statement.major.place, motion_.in_cycle() ? "GODLTA within a CYCLE is not read"
                                                                 : "GODLTA needs a point before it");
    if (v.size() != 1 && v.size() != 3 && v.size() != 6)
      throw InputError(statement.major.place,
                       fmt::format("GODLTA needs 1, 3 or 6 numbers, found {}", v.size()));
    const Eigen::Vector3d axis = v.size() == 6   ? system_.Direction(v, 3, statement)
                                 : v.size() == 3 ? AxisOfThree(statement)
                                                 : motion_.axis();
    if (v.size() == 6) GiveAxis();
    const Eigen::Vector3d step =
        v.size() == 1
            ? Eigen::Vector3d(system_.unit * v[0] * motion_.axis())
            : Eigen::Vector3d(system_.rotation * (system_.unit * Eigen::Vector3d(v[0], v[1], v[2])));
    motion_.MoveTo(motion_.at() + step, axis, statement.major.place);
  }

  void AddNotes() {
    const auto note = [&](size_t count, std::string_view text) {
      if (count > 0) path_.notes.push_back(fmt::format("{} {}", count, text));
    };
    note(motion_.circles(), "CIRCLE expanded by the chord tolerance");
    note(motion_.splines(), "NURBS expanded by the chord tolerance");
    note(motion_.holes(),
         "holes of drilling cycles, in and out straight at the cycle's feed, without dwells");
    if (tools_ > 1) note(tools_, "tool changes");
    note(
        zeros_.count(),
        "ORIGIN or TRANS: where the machine's zero lies; the points are taken in the part's system as given");
    if (!moved_out_of_.empty())
      path_.notes.push_back(
          fmt::format("coordinates were moved out of their system ({}) into the one that it "
                      "refers to",
                      moved_out_of_));
    tally_.AddNote(path_.notes);
  }

  void AddSource() {
    sections_.Finish({}, path_);
    CamSource& source = path_.source;
    source.sender = std::string(rules_.name);
    if (options_.sender) source.sender += " (by toolpath.cam.sender)";
    if (!recognised_.conflict.empty()) source.sender += ", with marks of " + recognised_.conflict;
    source.unit = unit_.ToText();
    source.frame = frame_name_;
    const bool keeps = rules_.three_numbers == ThreeNumbers::kKeep;
    if (three_) source.three_numbers = keeps ? "the axis stays" : "+z";
    if (unit_.used_key()) path_.keys_used.insert("unit");
    if (comments_.used_key() || zeros_.used_key()) path_.keys_used.insert("frame");
  }

  AptScanner scanner_;
  const std::string& name_;
  const CamReadOptions& options_;
  Recognised recognised_;
  const SenderRules& rules_;
  CamPath path_;
  SectionTracker sections_;
  AptMotion motion_;
  AptComments comments_;
  AptUnit unit_;
  MachineZeros zeros_;
  AptSystem system_;
  AptFeed feed_;
  std::optional<AptNurbs> nurbs_;
  std::optional<AptCycle> last_cycle_;
  WordTally tally_;
  std::string frame_name_ = "as written";
  std::string moved_out_of_;  // the first system that moves points
  bool units_stated_ = false;
  bool leaned_ = false;  // the axis is the one of a point with six numbers
  bool stale_ = false;   // system and axis are those of another operation
  bool three_ = false;   // a point gave three numbers
  size_t tools_ = 0;
};

}  // namespace

CamPath ReadApt(std::string_view bytes, const std::string& name, const CamReadOptions& options) {
  return AptReader(bytes, name, options).Read();
}

}  // namespace millpose
