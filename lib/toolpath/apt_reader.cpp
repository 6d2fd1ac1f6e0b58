// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "toolpath/apt_scanner.hpp"
#include "toolpath/arc.hpp"
#include "toolpath/cam_path.hpp"

namespace millpose {
namespace {

constexpr double kInch = 25.4;
constexpr double kMaxRadius = 1e6;  // mm: bounds the number of points that a circle becomes

// Statements that say nothing about where the tool goes.
const std::vector<std::string_view> kSilent{
    "PARTNO", "PPRINT", "REMARK",      "MACHIN", "PAINT",     "COOLNT", "MULTAX", "FINI",   "INSERT",
    "STOP",   "OPSTOP", "DELAY",       "CUTCOM", "TOOL PATH", "CUTTER", "TLDATA", "AUXFUN", "PREFUN",
    "HEAD",   "MODE",   "END-OF-PATH", "CLDIST", "TPRINT",    "SELECT", "CLEARP", "AUTOPS", "NOPOST",
    "DISPLY", "REWIND", "END",         "LEADER", "SEQNO",     "TOLER",  "INTOL",  "OUTTOL"};

bool IsSilent(const std::string& major) {
  return std::ranges::any_of(kSilent, [&](std::string_view word) {
    // Free text may follow the word without a slash: "PPRINT OPERATION 1", "PARTNO P1".
    return major == word ||
           (major.starts_with(word) && major.size() > word.size() && major[word.size()] == ' ');
  });
}

class AptReader {
 public:
  AptReader(std::string_view bytes, const std::string& name, double chord_tolerance)
      : scanner_(bytes, name), name_(name), tolerance_(chord_tolerance) {}

  CamPath Read() {
    AptStatement statement;
    while (scanner_.Next(statement)) Take(statement);
    if (circle_) throw InputError(circle_->place, "a CIRCLE is not followed by the GOTO that it leads to");
    if (path_.points.empty()) throw InputError({name_}, "the file holds no GOTO");
    AddNotes();
    return std::move(path_);
  }

 private:
  struct Circle {
    Eigen::Vector3d centre, axis;
    Place place;
  };

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
      Feed(statement);
    } else if (major == "SPINDL") {
      Spindle(statement);
    } else if (major == "CIRCLE") {
      const std::vector<double> v = Numbers(statement, 6, 11);
      const Eigen::Vector3d axis(v[3], v[4], v[5]);
      if (!(axis.norm() > 0)) throw InputError(statement.minors[3].place, "the circle's axis has no length");
      circle_ = Circle{Placed({v[0], v[1], v[2]}), (rotation_ * axis).normalized(), statement.major.place};
    } else if (major == "TLAXIS") {
      axis_ = Axis(Numbers(statement, 3, 3), 0, statement);
    } else if (major == "MSYS") {
      CoordinateSystem(statement);
    } else if (major == "UNITS" || major == "UNIT") {
      Units(statement);
    } else if (major == "LOADTL" || major == "TOOLNO") {
      fresh_ = true;
      ++tools_;
    } else if (major == "CYCLE") {
      cycle_ = statement.minors.empty() || statement.minors[0].text != "OFF";
    } else if (!IsSilent(major)) {
      ++unknown_[major.substr(0, 40)];
    }
  }

  // The statement's numbers, `least` to `most` of them.
  std::vector<double> Numbers(const AptStatement& statement, size_t least, size_t most) const {
    std::vector<double> numbers;
    for (const AptWord& word : statement.minors) {
      const std::optional<double> number = ParseNumber(word.text);
      if (!number)
        throw InputError(word.place, fmt::format("{} needs numbers, found \"{}\"", statement.major.text,
                                                 word.text.substr(0, 40)));
      numbers.push_back(*number);
    }
    if (numbers.size() < least || numbers.size() > most)
      throw InputError(statement.major.place, fmt::format("{} needs {} to {} numbers, found {}",
                                                          statement.major.text, least, most, numbers.size()));
    return numbers;
  }

  Eigen::Vector3d Placed(const Eigen::Vector3d& p) const { return origin_ + rotation_ * (unit_ * p); }

  Eigen::Vector3d Axis(const std::vector<double>& v, size_t first, const AptStatement& statement) const {
    const Eigen::Vector3d axis(v[first], v[first + 1], v[first + 2]);
    if (!(axis.norm() > 1e-6)) throw InputError(statement.minors[first].place, "the tool axis has no length");
    return (rotation_ * axis).normalized();
  }

  void Goto(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 3, 6);
    if (v.size() != 3 && v.size() != 6)
      throw InputError(statement.major.place,
                       fmt::format("{} needs 3 or 6 numbers, found {}", statement.major.text, v.size()));
    const Eigen::Vector3d before = axis_;
    if (v.size() == 6) axis_ = Axis(v, 3, statement);
    MoveTo(Placed({v[0], v[1], v[2]}), before, statement.major.place.line);
  }

  void GoDelta(const AptStatement& statement) {
    const std::vector<double> v = Numbers(statement, 1, 3);
    if (path_.points.empty()) throw InputError(statement.major.place, "GODLTA needs a point before it");
    if (v.size() == 2) throw InputError(statement.major.place, "GODLTA needs 1 or 3 numbers, found 2");
    const Eigen::Vector3d step =
        v.size() == 1 ? Eigen::Vector3d(unit_ * v[0] * axis_)
                      : Eigen::Vector3d(rotation_ * (unit_ * Eigen::Vector3d(v[0], v[1], v[2])));
    MoveTo(path_.points.back().position + step, axis_, statement.major.place.line);
  }

  void MoveTo(const Eigen::Vector3d& to, const Eigen::Vector3d& axis_before, int line) {
    if (cycle_) {
      ++in_cycles_;
      fresh_ = true;
      return;
    }
    std::vector<Eigen::Vector3d> way{to};
    if (circle_ && !path_.points.empty() && !rapid_) {
      const double radius =
          std::max((path_.points.back().position - circle_->centre).norm(), (to - circle_->centre).norm());
      if (!(radius <= kMaxRadius))
        throw InputError(circle_->place,
                         fmt::format("the circle's radius of {:.4g} mm is above {} mm", radius, kMaxRadius));
      way = ArcPoints(path_.points.back().position, to, circle_->centre, circle_->axis, tolerance_);
      ++circles_;
    }
    circle_.reset();
    for (size_t i = 0; i < way.size(); ++i) {
      const double share = static_cast<double>(i + 1) / static_cast<double>(way.size());
      Eigen::Vector3d axis = axis_before + share * (axis_ - axis_before);
      axis = i + 1 < way.size() && axis.norm() > 1e-6 ? Eigen::Vector3d(axis.normalized()) : axis_;
      path_.points.push_back({way[i], axis, Feed(), rapid_, fresh_, line});
      fresh_ = false;
    }
    rapid_ = false;  // RAPID holds for the next motion only
  }

  double Feed() const { return per_revolution_ ? feed_ * revolutions_ : feed_; }

  // "250.0,MMPM", "MMPM,250.0", "250.0".
  void Feed(const AptStatement& statement) {
    std::optional<double> value;
    double unit = unit_ / 60;
    bool per_revolution = false;
    for (const AptWord& word : statement.minors) {
      if (const auto number = ParseNumber(word.text); number && !value) {
        value = number;
      } else if (word.text == "MMPM" || word.text == "IPM") {
        unit = (word.text == "IPM" ? kInch : 1.0) / 60;
      } else if (word.text == "MMPR" || word.text == "IPR") {
        unit = word.text == "IPR" ? kInch : 1.0;
        per_revolution = true;
      } else if (word.text == "RAPID") {
        rapid_ = true;
        return;
      } else {
        ++unknown_["FEDRAT/" + word.text.substr(0, 40)];
      }
    }
    if (!value || !(*value > 0)) throw InputError(statement.major.place, "FEDRAT needs a feed above 0");
    feed_ = *value * unit;
    per_revolution_ = per_revolution;
  }

  void Spindle(const AptStatement& statement) {
    for (const AptWord& word : statement.minors)
      if (const auto number = ParseNumber(word.text); number && *number > 0) revolutions_ = *number / 60;
  }

  void Units(const AptStatement& statement) {
    const std::string unit = statement.minors.empty() ? "" : statement.minors[0].text;
    if (unit == "MM") {
      unit_ = 1;
    } else if (unit == "INCHES" || unit == "INCH" || unit == "IN") {
      unit_ = kInch;
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
    if (moved_)
      path_.notes.emplace_back("coordinates were moved from MSYS into the system that it refers to");
    for (const auto& [word, count] : unknown_) note(count, fmt::format("\"{}\" not known, ignored", word));
  }

  AptScanner scanner_;
  const std::string& name_;
  double tolerance_;
  CamPath path_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(), axis_ = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  double unit_ = 1, feed_ = 0, revolutions_ = 0;
  bool per_revolution_ = false, rapid_ = false, fresh_ = false, cycle_ = false, moved_ = false;
  std::optional<Circle> circle_;
  size_t circles_ = 0, in_cycles_ = 0, tools_ = 0;
  std::map<std::string, size_t> unknown_;
};

}  // namespace

CamPath ReadApt(std::string_view bytes, const std::string& name, double chord_tolerance) {
  return AptReader(bytes, name, chord_tolerance).Read();
}

}  // namespace millpose
