// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "toolpath/apt_circle.hpp"
#include "toolpath/apt_feed.hpp"
#include "toolpath/apt_scanner.hpp"
#include "toolpath/cam_path.hpp"

namespace millpose {
namespace {

constexpr size_t kMaxPoints = 2'000'000;  // bounds what circles of a small file can become
constexpr size_t kMostListed = 50;        // unknown words

// Statements that say nothing about where the tool goes.
const std::vector<std::string_view> kSilent{
    "PARTNO",      "PPRINT", "REMARK", "MACHIN", "PAINT",     "COOLNT", "MULTAX", "FINI",   "INSERT",
    "STOP",        "OPSTOP", "DELAY",  "CUTCOM", "TOOL PATH", "AUXFUN", "PREFUN", "HEAD",   "MODE",
    "END-OF-PATH", "CLDIST", "TPRINT", "SELECT", "CLEARP",    "AUTOPS", "NOPOST", "DISPLY", "REWIND",
    "END",         "LEADER", "SEQNO",  "TOLER",  "INTOL",     "OUTTOL"};

bool IsSilent(const std::string& major) {
  return std::ranges::any_of(kSilent, [&](std::string_view word) {
    // Free text may follow the word without a slash: "PPRINT OPERATION 1", "PARTNO P1".
    return major == word ||
           (major.starts_with(word) && major.size() > word.size() && major[word.size()] == ' ');
  });
}

// Motions along surfaces, which only an APT processor can resolve.
const std::vector<std::string_view> kUnreadable{"TLON",  "TLLFT",  "TLRGT", "TLONPS", "TLOFPS",
                                                "GOFWD", "GOBACK", "GOLFT", "GORGT",  "GODOWN",
                                                "GOUP",  "GO",     "GOCLER"};

std::string_view FirstWord(std::string_view major) { return major.substr(0, major.find_first_of(", ")); }

class AptReader {
 public:
  AptReader(std::string_view bytes, const std::string& name, double chord_tolerance)
      : scanner_(bytes, name), name_(name), tolerance_(chord_tolerance) {}

  CamPath Read() {
    AptStatement statement;
    while (scanner_.Next(statement)) Take(statement);
    if (circle_) throw InputError(circle_->place, "a CIRCLE is not followed by the GOTO that it leads to");
    if (path_.points.empty()) throw InputError({name_}, "the file holds no GOTO");
    CheckReach(path_, name_);
    AddNotes();
    return std::move(path_);
  }

 private:
  void Take(const AptStatement& statement) {
    const std::string& major = statement.major.text;
    if (major == "GOTO") {
      Goto(statement);
    } else if (major == "FROM") {
      rapid_ = true;
      Goto(statement);
    } else if (major == "GODLTA") {
      GoDelta(statement);
    } else if (major == "RAPID") {
      rapid_ = true;
    } else if (major == "FEDRAT") {
      if (!feed_.Take(statement, unit_, unknown_)) rapid_ = true;
    } else if (major == "SPINDL") {
      feed_.TakeSpindle(statement, path_.cutters.empty() ? 0 : path_.cutters.back().diameter);
    } else if (major == "CIRCLE") {
      Circle(statement);
    } else if (major == "INDIRV") {
      const std::vector<double> v = Numbers(statement, 3, 3);
      tangent_ = Direction(v, 0, statement);
    } else if (std::ranges::find(kUnreadable, FirstWord(major)) != kUnreadable.end()) {
      TakeDriveMotion(statement);
    } else if (major == "CUTTER" || major == "TLDATA") {
      Cutter(statement);
    } else if (major == "TLAXIS") {
      axis_ = Direction(Numbers(statement, 3, 3), 0, statement);
    } else if (major == "MSYS") {
      CoordinateSystem(statement);
    } else if (major == "UNITS" || major == "UNIT") {
      Units(statement);
    } else if (major == "ORIGIN" || major == "TRANS") {
      machine_zeros_ += Numbers(statement, 1, 6).empty() ? 0 : 1;
    } else if (major == "TRACUT") {
      if (statement.minors.empty() || statement.minors.back().text != "NOMORE")
        throw InputError(statement.major.place,
                         "TRACUT is not read: let the CAM system write the points as they are milled");
    } else if (major == "LOADTL" || major == "TOOLNO") {
      fresh_ = true;
      ++tools_;
    } else if (major == "CYCLE") {
      cycle_ = statement.minors.empty() || statement.minors[0].text != "OFF";
    } else if (!IsSilent(major)) {
      ++unknown_[major.substr(0, 40)];
    }
  }

  Eigen::Vector3d Placed(const Eigen::Vector3d& p) const { return origin_ + rotation_ * (unit_ * p); }

  Eigen::Vector3d Direction(const std::vector<double>& v, size_t first, const AptStatement& statement) const {
    const Eigen::Vector3d direction(v[first], v[first + 1], v[first + 2]);
    if (!(direction.norm() > 1e-6 && direction.norm() < 1e6))
      throw InputError(statement.minors[first].place, "the direction has no length");
    return (rotation_ * direction).normalized();
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
    circle.centre = Placed({v[0], v[1], v[2]});
    circle.axis = Direction(v, 3, plain);
    if (v.size() > 6) circle.radius = unit_ * v[6];
    circle.clockwise = v.size() == 11;
    circle.place = statement.major.place;
    circle_ = circle;
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
    arc.centre = Placed({circle[0], circle[1], circle[2]});
    arc.radius = unit_ * circle[3];
    arc.place = statement.major.place;
    circle_ = arc;
    if (path_.points.empty()) throw InputError(arc.place, "the circle needs a point before it");
    MoveTo(Placed({line[3], line[4], line[5]}), axis_, arc.place.line);
  }

  static InputError Unreadable(const Place& place, const AptStatement& statement) {
    return {place, fmt::format("the motion \"{}\" cannot be read; known are GOTO, GODLTA, CIRCLE with a GOTO "
                               "and TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z)",
                               statement.major.text.substr(0, 40))};
  }

  // CUTTER/d[,r] and NX's TLDATA/MILL,d,r,length,….
  void Cutter(const AptStatement& statement) {
    std::vector<double> numbers;
    for (const AptWord& word : statement.minors)
      if (const auto number = ParseNumber(word.text)) numbers.push_back(unit_ * *number);
    if (numbers.empty() || !(numbers[0] > 0)) return;
    path_.cutters.push_back({numbers[0], numbers.size() > 1 ? numbers[1] : 0, statement.major.place.line});
  }

  void Goto(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 3, 6);
    if (v.size() != 3 && v.size() != 6)
      throw InputError(statement.major.place,
                       fmt::format("{} needs 3 or 6 numbers, found {}", statement.major.text, v.size()));
    const Eigen::Vector3d before = axis_;
    if (v.size() == 6) axis_ = Direction(v, 3, statement);
    MoveTo(Placed({v[0], v[1], v[2]}), before, statement.major.place.line);
  }

  void GoDelta(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 1, 6);
    if (path_.points.empty()) throw InputError(statement.major.place, "GODLTA needs a point before it");
    if (v.size() != 1 && v.size() != 3 && v.size() != 6)
      throw InputError(statement.major.place,
                       fmt::format("GODLTA needs 1, 3 or 6 numbers, found {}", v.size()));
    const Eigen::Vector3d before = axis_;
    const Eigen::Vector3d step =
        v.size() == 1 ? Eigen::Vector3d(unit_ * v[0] * axis_)
                      : Eigen::Vector3d(rotation_ * (unit_ * Eigen::Vector3d(v[0], v[1], v[2])));
    if (v.size() == 6) axis_ = Direction(v, 3, statement);
    MoveTo(path_.points.back().position + step, before, statement.major.place.line);
  }

  void MoveTo(const Eigen::Vector3d& to, const Eigen::Vector3d& axis_before, int line) {
    if (cycle_) {
      ++in_cycles_;
      fresh_ = true;
      return;
    }
    std::vector<Eigen::Vector3d> way{to};
    if (circle_ && !path_.points.empty() && !rapid_) {
      circle_->tangent = tangent_;
      way = CirclePoints(*circle_, path_.points.back().position, to, arriving_, tolerance_);
      ++circles_;
    }
    if (path_.points.size() + way.size() > kMaxPoints)
      throw InputError({name_, line}, fmt::format("the path has more than {} points", kMaxPoints));
    circle_.reset();
    tangent_.reset();
    for (size_t i = 0; i < way.size(); ++i) {
      const double share = static_cast<double>(i + 1) / static_cast<double>(way.size());
      Eigen::Vector3d axis = axis_before + share * (axis_ - axis_before);
      axis = i + 1 < way.size() && axis.norm() > 1e-6 ? Eigen::Vector3d(axis.normalized()) : axis_;
      if (!path_.points.empty()) arriving_ = way[i] - path_.points.back().position;
      path_.points.push_back({way[i], axis, feed_.Rate(), rapid_, fresh_, line});
      fresh_ = false;
    }
    rapid_ = false;  // RAPID holds for the next motion only
  }

  void Units(const AptStatement& statement) {
    const std::string unit = statement.minors.empty() ? "" : statement.minors[0].text;
    if (unit == "MM") {
      unit_ = 1;
    } else if (unit == "INCHES" || unit == "INCH" || unit == "IN") {
      unit_ = 25.4;
    } else if (unit == "CM") {
      unit_ = 10;
    } else {
      throw InputError(statement.major.place,
                       fmt::format("UNITS needs MM, CM or INCHES, found \"{}\"", unit.substr(0, 40)));
    }
  }

  // Origin, X axis, Y axis of the system that all further coordinates are given in.
  void CoordinateSystem(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 9, 9);
    const Eigen::Vector3d x(v[3], v[4], v[5]), y(v[6], v[7], v[8]), z = x.cross(y);
    if (!(z.norm() > 1e-6)) throw InputError(statement.major.place, "the axes of MSYS do not span a plane");
    origin_ = unit_ * Eigen::Vector3d(v[0], v[1], v[2]);
    rotation_.col(0) = x.normalized();
    rotation_.col(2) = z.normalized();
    rotation_.col(1) = rotation_.col(2).cross(rotation_.col(0));
    axis_ = rotation_.col(2);
    if (!origin_.isZero(1e-9) || !rotation_.isIdentity(1e-9)) moved_ = true;
  }

  void AddNotes() {
    const auto note = [&](size_t count, std::string_view text) {
      if (count > 0) path_.notes.push_back(fmt::format("{} {}", count, text));
    };
    note(circles_, "CIRCLE expanded by the chord tolerance");
    note(in_cycles_, "points within drilling cycles left out");
    if (tools_ > 1) note(tools_, "tool changes; all are taken as passes of one job");
    note(
        machine_zeros_,
        "ORIGIN or TRANS: where the machine's zero lies; the points are taken in the part's system as given");
    if (moved_)
      path_.notes.emplace_back("coordinates were moved from MSYS into the system that it refers to");
    size_t listed = 0;
    for (const auto& [word, count] : unknown_)
      if (++listed <= kMostListed) note(count, fmt::format("\"{}\" not known, ignored", word));
    if (listed > kMostListed) note(listed - kMostListed, "further kinds of words not known, ignored");
  }

  AptScanner scanner_;
  const std::string& name_;
  double tolerance_;
  CamPath path_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(), axis_ = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  double unit_ = 1;
  AptFeed feed_;
  bool rapid_ = false, fresh_ = false, cycle_ = false, moved_ = false;
  std::optional<AptCircle> circle_;
  std::optional<Eigen::Vector3d> tangent_;              // INDIRV, for the next motion
  Eigen::Vector3d arriving_ = Eigen::Vector3d::Zero();  // the motion before
  size_t circles_ = 0, in_cycles_ = 0, tools_ = 0, machine_zeros_ = 0;
  std::map<std::string, size_t> unknown_;
};

}  // namespace

CamPath ReadApt(std::string_view bytes, const std::string& name, double chord_tolerance) {
  return AptReader(bytes, name, chord_tolerance).Read();
}

}  // namespace millpose
