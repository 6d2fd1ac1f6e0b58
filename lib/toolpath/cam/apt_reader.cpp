// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "base/text.hpp"
#include "toolpath/cam/apt_motion.hpp"
#include "toolpath/cam/apt_words.hpp"

namespace millpose {
namespace {

class AptReader {
 public:
  AptReader(std::string_view bytes, const std::string& name, const CamReadOptions& options)
      : scanner_(bytes, name), name_(name), motion_(options, path_) {}

  CamPath Read() {
    AptStatement statement;
    try {
      while (scanner_.Next(statement)) Take(statement);
      EndNurbs();
      motion_.CheckEnd();
    } catch (const InputError& error) {
      tally_.RefuseUnknown(error.problems());
    }
    tally_.RefuseUnknown({});
    if (path_.points.empty() && path_.holes_left_out.empty())
      throw InputError({name_}, "the file holds no GOTO");
    CheckReach(path_, name_);
    AddNotes();
    return std::move(path_);
  }

 private:
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
      return tally_.CountHarmless(word);
    }
    EndNurbs();
    if (meaning == AptMeaning::kMotion) return TakeMotion(statement);
    if (meaning == AptMeaning::kState) return TakeState(statement);
    if (meaning == AptMeaning::kSurfaceMotion) return TakeDriveMotion(statement);
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
    } else if (major == "CIRCLE") {
      Circle(statement);
    } else if (major == "INDIRV") {
      motion_.SetTangent(system_.Direction(Numbers(statement, 3, 3), 0, statement));
    } else if (major == "NURBS") {
      nurbs_.emplace(statement);
    } else {
      Cycle(statement);
    }
  }

  void TakeState(const AptStatement& statement) {
    const std::string& major = statement.major.text;
    if (major == "FEDRAT") {
      if (!feed_.Take(statement, system_.unit)) motion_.SetRapid();
    } else if (major == "SPINDL") {
      feed_.TakeSpindle(statement, path_.cutters.empty() ? 0 : path_.cutters.back().diameter);
    } else if (major == "CUTTER" || major == "TLDATA") {
      Cutter(statement);
    } else if (major == "TLAXIS") {
      motion_.SetAxis(system_.Direction(Numbers(statement, 3, 3), 0, statement));
    } else if (major == "MSYS") {
      system_.TakeMsys(statement);
      motion_.SetAxis(system_.rotation.col(2));
      moved_ = moved_ || !system_.origin.isZero(1e-9) || !system_.rotation.isIdentity(1e-9);
    } else if (major == "UNITS" || major == "UNIT") {
      system_.TakeUnits(statement);
    } else if (major == "ORIGIN" || major == "TRANS") {
      machine_zeros_ += Numbers(statement, 1, 6).empty() ? 0 : 1;
    } else {  // LOADTL, TOOLNO, TURRET, LOAD/TOOL
      motion_.SetFresh();
      ++tools_;
    }
    motion_.SetFeed(feed_.Rate());
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

  // "xc,yc,zc,i,j,k[,r]"; NX adds total tolerance, ratio, diameter and corner radius of the tool and means a
  // clockwise turn about the axis, "TIMES,n" with n turns begun.
  void Circle(const AptStatement& statement) {
    AptStatement plain = statement;
    AptCircle circle;
    const size_t words = plain.minors.size();
    if (words > 2 && plain.minors[words - 2].text == "TIMES") {
      const auto times = ParseNumber(plain.minors[words - 1].text);
      if (!times || *times < 1 || *times > 1000 || *times != std::floor(*times))
        throw InputError(plain.minors[words - 1].place, "TIMES needs a whole number from 1 to 1000");
      circle.full_turns = static_cast<int>(*times) - 1;
      plain.minors.resize(words - 2);
    }
    const std::vector<double> v = Numbers(plain, 6, 11);
    circle.centre = system_.Placed({v[0], v[1], v[2]});
    circle.axis = system_.Direction(v, 3, plain);
    if (v.size() > 6) circle.radius = system_.unit * v[6];
    circle.clockwise = v.size() > 7;
    circle.place = statement.major.place;
    motion_.SetCircle(circle);
  }

  // CATIA: "TLON,GOFWD/ (CIRCLE/ xc,yc,zc,r),ON,(LINE/ xc,yc,zc,xe,ye,ze)" after INDIRV, "ON,2,INTOF" for the
  // whole circle.
  void TakeDriveMotion(const AptStatement& statement) {
    std::vector<double> circle, line;
    std::vector<double>* list = nullptr;
    for (const AptWord& word : statement.minors) {
      std::string_view text = word.text;
      for (const auto& [head, numbers] : {std::pair("(CIRCLE/", &circle), std::pair("(LINE/", &line)})
        if (text.starts_with(head)) {
          list = numbers;
          text.remove_prefix(std::string_view(head).size());
        }
      const bool last = text.ends_with(')');
      if (last) text.remove_suffix(1);
      while (text.starts_with(' ')) text.remove_prefix(1);
      while (text.ends_with(' ')) text.remove_suffix(1);
      const auto number = ParseNumber(std::string(text));
      const bool between = list == nullptr && (text == "ON" || text == "2" || text == "INTOF");
      if (!between && (list == nullptr || !number)) throw Unreadable(word.place, statement);
      if (!between) list->push_back(*number);
      if (last) list = nullptr;
    }
    if (statement.major.text != "TLON,GOFWD" || circle.size() != 4 || line.size() != 6)
      throw Unreadable(statement.major.place, statement);
    AptCircle arc;
    arc.centre = system_.Placed({circle[0], circle[1], circle[2]});
    arc.radius = system_.unit * circle[3];
    arc.place = statement.major.place;
    motion_.SetCircle(arc);
    motion_.MoveTo(system_.Placed({line[3], line[4], line[5]}), motion_.axis(), arc.place);
  }

  static InputError Unreadable(const Place& place, const AptStatement& statement) {
    return {place,
            fmt::format("the motion \"{}\" cannot be read; known are GOTO, GODLTA, CIRCLE with a GOTO, "
                        "NURBS with KNOT and CNTRL, and "
                        "TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z)",
                        statement.major.text.substr(0, 40))};
  }

  // CUTTER/d[,r] and NX's TLDATA/MILL,d,r,length,….
  void Cutter(const AptStatement& statement) {
    std::vector<double> numbers;
    for (const AptWord& word : statement.minors)
      if (const auto number = ParseNumber(word.text)) numbers.push_back(system_.unit * *number);
    if (numbers.empty() || !(numbers[0] > 0)) return;
    path_.cutters.push_back({numbers[0], numbers.size() > 1 ? numbers[1] : 0, statement.major.place.line});
  }

  void Goto(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 3, 6);
    if (v.size() != 3 && v.size() != 6)
      throw InputError(statement.major.place,
                       fmt::format("{} needs 3 or 6 numbers, found {}", statement.major.text, v.size()));
    motion_.MoveTo(system_.Placed({v[0], v[1], v[2]}),
                   v.size() == 6 ? system_.Direction(v, 3, statement) : motion_.axis(),
                   statement.major.place);
  }

  void GoDelta(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 1, 6);
    if (!motion_.HasPoint() || motion_.in_cycle())
      throw InputError(statement.major.place, motion_.in_cycle() ? "GODLTA within a CYCLE is not read"
                                                                 : "GODLTA needs a point before it");
    if (v.size() != 1 && v.size() != 3 && v.size() != 6)
      throw InputError(statement.major.place,
                       fmt::format("GODLTA needs 1, 3 or 6 numbers, found {}", v.size()));
    const Eigen::Vector3d step =
        v.size() == 1
            ? Eigen::Vector3d(system_.unit * v[0] * motion_.axis())
            : Eigen::Vector3d(system_.rotation * (system_.unit * Eigen::Vector3d(v[0], v[1], v[2])));
    motion_.MoveTo(motion_.at() + step, v.size() == 6 ? system_.Direction(v, 3, statement) : motion_.axis(),
                   statement.major.place);
  }

  void AddNotes() {
    const auto note = [&](size_t count, std::string_view text) {
      if (count > 0) path_.notes.push_back(fmt::format("{} {}", count, text));
    };
    note(motion_.circles(), "CIRCLE expanded by the chord tolerance");
    note(motion_.splines(), "NURBS expanded by the chord tolerance");
    note(motion_.holes(),
         "holes of drilling cycles, in and out straight at the cycle's feed, without dwells");
    if (tools_ > 1) note(tools_, "tool changes; all are taken as passes of one job");
    note(
        machine_zeros_,
        "ORIGIN or TRANS: where the machine's zero lies; the points are taken in the part's system as given");
    if (moved_)
      path_.notes.emplace_back("coordinates were moved from MSYS into the system that it refers to");
    tally_.AddNote(path_.notes);
  }

  AptScanner scanner_;
  const std::string& name_;
  CamPath path_;
  AptMotion motion_;
  AptSystem system_;
  AptFeed feed_;
  std::optional<AptNurbs> nurbs_;
  std::optional<AptCycle> last_cycle_;
  WordTally tally_;
  bool moved_ = false;
  size_t tools_ = 0, machine_zeros_ = 0;
};

}  // namespace

CamPath ReadApt(std::string_view bytes, const std::string& name, const CamReadOptions& options) {
  return AptReader(bytes, name, options).Read();
}

}  // namespace millpose
