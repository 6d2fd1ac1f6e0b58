// SPDX-License-Identifier: GPL-3.0-or-later
// APT in the dialects of its senders.
#include <cmath>

#include "base/units.hpp"
#include "tests/toolpath/dialect_writer.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
using Kind = Want::Kind;

enum class System : uint8_t { kNx, kCatia, kCreo, kAutodesk, kPlain };

class AptDialect : public DialectWriter {
 public:
  explicit AptDialect(uint64_t index)
      : DialectWriter(index, 211), system_(static_cast<System>(random_.Below(5))) {
    options_.chord_tolerance = kDialectChord;
    Head();
    Spindle();
    Rapid();
    const int motions = 3 + static_cast<int>(random_.Below(10));
    for (int i = 0; i < motions; ++i) Step();
    Line("FINI");
    CheckUnit();
  }

 private:
  bool Is(System system) const { return system_ == system; }
  std::string Numbers(const Vector& v) { return fmt::format("{:.9f}, {:.9f},{:.9f}", v.x(), v.y(), v.z()); }

  void Head() {
    inch_ = Chance(0.3);
    stated_ = Chance(0.6);
    const std::string units = fmt::format("UNITS/{}", inch_ ? (Chance(0.5) ? "INCHES" : "INCH") : "MM");
    if (Is(System::kAutodesk)) Line("MODE/MILL");
    if (Is(System::kCreo)) Line("$$-> MFGNO / GENERATED");
    if (Is(System::kCatia)) Line("$$ CATIA APT VERSION 1.0");
    Line(Is(System::kCatia) ? "PARTNO GENERATED" : "PARTNO/'GENERATED'");
    if (stated_) Line(units);
    if (Is(System::kAutodesk)) Line("MULTAX/ON");
    if (Is(System::kNx)) Line("TOOL PATH/OP1,TOOL,T");
    if (Chance(0.4)) Frame();
    Tool();
    if (!stated_ && Chance(0.2)) {
      options_.unit = Unit();
      answered_ = true;
    }
  }

  double Unit() const { return inch_ ? 25.4 : 1; }

  // Without UNITS the words of feeds tell, but for inches; nothing tells but a cutter of at least 6.
  void CheckUnit() {
    if (stated_ || answered_) return;
    if (inch_ || (fed_ && smallest_ < 2) || (!fed_ && smallest_ < 6)) Refuse("the unit is not stated");
  }

  void Frame() {
    const Vector origin = Printed(random_.Vector(100 / Unit()));
    const Vector x = Printed(Vector(random_.Vector(1).normalized()));
    const Vector y = Printed(Vector(x.cross(random_.Vector(1)).normalized()));
    Eigen::Matrix3d rotation;
    rotation << x, y, x.cross(y);
    if (Is(System::kNx)) {
      Line(fmt::format("MSYS/{},{},{}", Numbers(origin), Numbers(x), Numbers(y)));
    } else {
      const bool identity = !Is(System::kCatia) && Chance(0.5);
      if (identity) rotation.setIdentity();
      const Vector shift = identity ? Vector(Vector::Zero()) : origin;
      if (!identity && !Is(System::kCatia)) Refuse("a frame whose meaning is not known");
      if (Is(System::kCatia)) StateFrame();
      if (Is(System::kCatia)) Line("$$*CATIA0\n$$ Program.1");
      if (!Is(System::kCatia)) Line(Comment(rotation, shift));
      for (int r = 0; Is(System::kCatia) && r < 3; ++r)
        Line(fmt::format("$$ {:.9f} {:.9f} {:.9f} {:.9f}", rotation(r, 0), rotation(r, 1), rotation(r, 2),
                         shift[r]));
      origin_ = Unit() * shift;
      SetRotation(rotation);
      return;
    }
    origin_ = Unit() * origin;
    SetRotation(rotation);
  }

  // Of the files with turned systems most say by the job that columns are meant; the others are refused.
  void StateFrame() {
    if (!asked_ && Chance(0.8)) options_.frame = CamFrame::kStated;
    asked_ = true;
    if (!options_.frame) Refuse("a CATIA0 that turns the axes");
  }

  // Creo's goes on over lines; another's word is no mark of Creo.
  std::string Comment(const Eigen::Matrix3d& rotation, const Vector& shift) {
    std::string line = Is(System::kCreo) ? "$$-> CSYS / " : "$$ MATRIX ";
    for (int r = 0; r < 3; ++r)
      line += fmt::format("{}{:.9f}, {:.9f}, {:.9f}, {:.9f}",
                          r == 0              ? ""
                          : Is(System::kCreo) ? ", $\n  "
                                              : ", ",
                          rotation(r, 0), rotation(r, 1), rotation(r, 2), shift[r]);
    return line;
  }

  void SetRotation(const Eigen::Matrix3d& rotation) {
    rotation_.col(0) = rotation.col(0).normalized();
    rotation_.col(2) = rotation.col(0).cross(rotation.col(1)).normalized();
    rotation_.col(1) = rotation_.col(2).cross(rotation_.col(0));
    axis_ = Vector::UnitZ();
    by_point_ = false;
  }

  void Tool() {
    const int number = 1 + static_cast<int>(random_.Below(3));
    const double diameter = Printed(Between(3, 30) / Unit());
    smallest_ = std::min(smallest_, diameter);
    now_.tool = std::to_string(number) + (Is(System::kNx) ? " T" : "");
    now_.diameter = Unit() * diameter;
    const std::string cutter = Is(System::kNx)     ? fmt::format("TLDATA/MILL,{:.9f},0,50,0,0", diameter)
                               : Is(System::kCreo) ? fmt::format("$$-> CUTTER / {:.9f}", diameter)
                                                   : fmt::format("CUTTER/{:.9f}, 0.0", diameter);
    const std::string load = Is(System::kNx)         ? fmt::format("LOAD/TOOL,{}", number)
                             : Is(System::kAutodesk) ? fmt::format("LOADTL/{}, 0, 60.0, {}", number, number)
                                                     : fmt::format("LOADTL/{}", number);
    Line(Is(System::kCreo) ? load : cutter);
    Line(Is(System::kCreo) ? cutter : load);
  }

  void Spindle() {
    now_.rpm = Printed(Between(1000, 20000));
    now_.sense = Chance(0.3) ? 2 : 1;
    const std::string sense = now_.sense == 2 ? "CCLW" : "CLW";
    switch (random_.Below(3)) {
      case 0:
        return Line(fmt::format("SPINDL/{:.9f},RPM,{}", now_.rpm, sense));
      case 1:
        return Line(fmt::format("SPINDL/RPM,{:.9f},{}", now_.rpm, sense));
      default:
        return Line(fmt::format("SPINDL/{},{:.9f}", sense, now_.rpm));
    }
  }

  Vector NextPoint() { return Printed(Vector(at_ + random_.Vector(50 / Unit()))); }

  // Writes three or six numbers, and knows what the sender means by three.
  std::string Axis(bool may_lean) {
    if (may_lean && Chance(0.4)) {
      const Vector axis = Printed(Vector(random_.Vector(1) + Vector(0, 0, 1.5)));
      axis_ = axis.normalized();
      by_point_ = true;
      return "," + Numbers(axis);
    }
    const bool leans = by_point_ && axis_ != Vector::UnitZ();
    if (leans && Is(System::kPlain)) Refuse("three numbers behind a leaning tool");
    if (leans && (Is(System::kCreo) || Is(System::kAutodesk))) axis_ = Vector::UnitZ();
    return "";
  }

  void Add(Want want, const Vector& p) {
    at_ = p;
    want.to = origin_ + rotation_ * (Unit() * p);
    want.axis = rotation_ * axis_;
    want.feed = want.kind == Kind::kRapid ? -1 : feed_;
    wants_.push_back(want);
    if (want.kind != Kind::kRapid) Cut();
  }

  void Rapid() {
    Line("RAPID");
    const Vector p = NextPoint();
    const std::string axis = Axis(true);
    Line("GOTO/" + Numbers(p) + axis);
    Add({.kind = Kind::kRapid}, p);
  }

  void Step() {
    switch (random_.Below(10)) {
      case 0:
        Tool();
        if (Chance(0.5)) Spindle();
        return Rapid();
      case 1:
        Line(Chance(0.5) ? "MULTAX/OFF" : "MULTAX/ON");
        return Straight();
      case 2:
        return Feed();
      case 3:
        if (Is(System::kNx) || Is(System::kCatia)) {
          Frame();
          return Rapid();
        }
        return Arc();
      case 4:
        if (Chance(0.15)) Zero();
        return Straight();
      case 5:
        return Holes();
      default:
        return Straight();
    }
  }

  void Straight() {
    const Vector p = NextPoint();
    const std::string axis = Axis(true);
    Line("GOTO/" + Numbers(p) + axis);
    Add({}, p);
  }

  void Zero() {
    const Vector zero = random_.Vector(50);
    Line(fmt::format("{}/{}", Chance(0.5) ? "ORIGIN" : "TRANS", Numbers(zero)));
    Refuse("the machine's zero changes between points");
  }

  void Feed() {
    const double f = Printed(Between(50, 3000));
    Line(fmt::format("FEDRAT/{:.9f},{}", f, inch_ ? "IPM" : "MMPM"));
    feed_ = f * Unit() / 60;
    fed_ = true;
  }

  // Autodesk's MOVARC, as often round as its angle says.
  void Arc() {
    if (!Is(System::kAutodesk)) return Straight();
    const Vector about = Printed(Vector(random_.Vector(1).normalized())), unit = about.normalized();
    const Vector radial = unit.cross(random_.Vector(1)).normalized() * Between(2, 20) / Unit();
    const Vector centre = Printed(Vector(at_ - radial));
    const Vector a = at_ - centre - unit.dot(at_ - centre) * unit;
    const double part = Between(0.1, 6), rise = Between(-5, 5) / Unit();
    const auto turns = static_cast<double>(random_.Below(4));
    const Vector end =
        centre + std::cos(part) * a + std::sin(part) * unit.cross(a) + (unit.dot(at_ - centre) + rise) * unit;
    const Vector to = Printed(end);
    Line(fmt::format("MOVARC/{},{}, {:.9f}, ANGLE, {:.9f}", Numbers(centre), Numbers(about), a.norm(),
                     RadToDeg(part + 2 * kPi * turns)));
    const std::string axis = Axis(false);
    Line("GOTO/" + Numbers(to) + axis);
    Add({.kind = Kind::kArc,
         .to = {},
         .centre = origin_ + rotation_ * (Unit() * centre),
         .about = rotation_ * unit,
         .angle = part + 2 * kPi * turns},
        to);
  }

  // A cycle by places: depth, feed, clearance from the hole's top.
  void Holes() {
    const double depth = Printed(Between(3, 30) / Unit()), clear = Printed(Between(1, 9) / Unit());
    const double f = Printed(Between(50, 300));
    const std::string unit = inch_ ? "IPM" : "MMPM";
    Line(Chance(0.5) ? fmt::format("CYCLE/DRILL, {:.9f}, {}, {:.9f}, {:.9f}", depth, unit, f, clear)
                     : fmt::format("CYCLE/DRILL,{:.9f},{:.9f},{},{:.9f}", depth, f, unit, clear));
    fed_ = true;
    const double feed = std::exchange(feed_, f * Unit() / 60);
    const Vector p = NextPoint();
    const std::string axis = Axis(false);
    Line("GOTO/" + Numbers(p) + axis);
    Add({.kind = Kind::kRapid}, p + clear * axis_);
    Add({}, p - depth * axis_);
    Add({}, p + clear * axis_);
    Line("CYCLE/OFF");
    feed_ = feed;
  }

  System system_;
  bool inch_ = false, stated_ = false, answered_ = false, fed_ = false, asked_ = false;
  double smallest_ = 1e9, feed_ = 0;
  Vector origin_ = Vector::Zero(), at_ = Vector::Zero(), axis_ = Vector::UnitZ();
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  bool by_point_ = false;  // the axis is a point's
};

TEST(AptDialectGenerator, EachSendersWordsMeanWhatItMeansOrAreRefused) { ReadAll<AptDialect>(5); }

}  // namespace
}  // namespace millpose
