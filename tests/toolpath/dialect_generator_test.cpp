// SPDX-License-Identifier: GPL-3.0-or-later
// Random files in the dialects of their senders, written by writers that know what each sender means by its
// words, or that nobody can know it: the reader says the same, or refuses.
#include <cmath>

#include "base/error.hpp"
#include "base/units.hpp"
#include "tests/toolpath/generated_paths.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
using Kind = Want::Kind;
constexpr double kDialectChord = 0.02;

/// A tool at a speed, as the writer has set it.
struct Setting {
  std::string tool;
  double diameter = 0, rpm = 0;
  int sense = 0;
  bool operator==(const Setting&) const = default;
};

/// What both writers share: the text, what it means, and whether nobody can know what it means.
class DialectWriter {
 public:
  DialectWriter(uint64_t index, uint64_t seed) : random_(index, seed) {}

  /// Reads the file and compares; a file that must be refused and is read is a failure, so is the reverse.
  /// Returns whether it was read.
  bool Check(uint64_t index) {
    try {
      const CamPath read = ReadCamPath(text_, "generated", options_);
      EXPECT_EQ(why_refused_, "") << "file " << index << " is read\n" << text_;
      EXPECT_EQ(Difference(read, wants_, 1e-6, kDialectChord), "") << "file " << index << "\n" << text_;
      CheckSections(read, index);
      return true;
    } catch (const InputError& error) {
      EXPECT_NE(why_refused_, "") << "file " << index << ": " << error.what() << "\n" << text_;
      return false;
    }
  }

 protected:
  bool Chance(double share) { return random_.Chance(share); }
  double Between(double low, double high) { return random_.Between(low, high); }
  void Refuse(const std::string& why) {
    if (why_refused_.empty()) why_refused_ = why;
  }
  void Line(const std::string& line) { text_ += line + (Chance(0.05) ? "\r\n" : "\n"); }
  void Cut() {
    if (settings_.empty() || !(settings_.back() == now_)) settings_.push_back(now_);
  }

  WriterRandom random_;
  std::string text_, why_refused_;
  std::vector<Want> wants_;
  CamReadOptions options_;
  Setting now_;

 private:
  void CheckSections(const CamPath& read, uint64_t index) const {
    ASSERT_EQ(read.source.sections.size(), settings_.size()) << "file " << index << "\n" << text_;
    for (size_t i = 0; i < settings_.size(); ++i) {
      const CamSection& section = read.source.sections[i];
      EXPECT_EQ(section.tool, settings_[i].tool) << "file " << index << "\n" << text_;
      EXPECT_NEAR(section.diameter.value_or(0), settings_[i].diameter, 1e-6) << "file " << index << "\n"
                                                                             << text_;
      EXPECT_NEAR(60 * section.speed.value_or(0), settings_[i].rpm, 1e-6) << "file " << index << "\n"
                                                                          << text_;
      EXPECT_EQ(static_cast<int>(section.sense), settings_[i].sense) << "file " << index << "\n" << text_;
    }
  }

  std::vector<Setting> settings_;  // of the cuts, neighbours differ
};

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

enum class Control : uint8_t { kLinuxCnc, kSinumerik, kMastercam, kPlain };

class GcodeDialect : public DialectWriter {
 public:
  explicit GcodeDialect(uint64_t index)
      : DialectWriter(index, 223), control_(static_cast<Control>(random_.Below(4))) {
    options_.chord_tolerance = kDialectChord;
    Head();
    Tool();
    Spindle();
    SourceLocation();
    const int motions = 3 + static_cast<int>(random_.Below(10));
    for (int i = 0; i < motions; ++i) Step();
    Line("M30");
  }

 private:
  bool Is(Control control) const { return control_ == control; }
  double Unit() const { return inch_ ? 25.4 : 1; }
  std::string Words(const Vector& v) { return fmt::format("X{:.9f} Y{:.9f} Z{:.9f}", v.x(), v.y(), v.z()); }

  void Head() {
    if (Is(Control::kLinuxCnc)) Line("(Post Processor: linuxcnc_post)");
    if (Is(Control::kSinumerik)) Line("%_N_GENERATED_MPF");
    if (Is(Control::kMastercam)) Line("%\nO100 (PART)\n(MASTERCAM - X9)");
    inch_ = Chance(0.3);
    const bool stated = Chance(0.8), answered = !stated && Chance(0.5);
    const std::string word = Is(Control::kSinumerik) ? (inch_ ? "G700" : "G710") : (inch_ ? "G20" : "G21");
    Line("G17 G90 G94 " + (stated ? word : ""));
    if (answered) options_.unit = Unit();
    if (!stated && !answered) Refuse("no unit");
    in_force_ = Is(Control::kSinumerik) ? "G500" : "G54";
    several_ = Chance(0.5);
    if (several_)
      for (const std::string name : {"G54", "G55", "G59", "G500", "G54.1 P3"})
        options_.offsets[name] = Printed(random_.Vector(300));
    shift_ = several_ ? options_.offsets[in_force_] : Vector(Vector::Zero());
  }

  void Tool() {
    now_.tool = std::to_string(1 + random_.Below(3));
    Line(Chance(0.5) ? "T" + now_.tool + " M6" : "M6 T" + now_.tool);
  }

  void Spindle() {
    now_.rpm = Printed(Between(500, 20000));
    now_.sense = Chance(0.3) ? 2 : 1;
    const char* sense = now_.sense == 2 ? "M4" : "M3";
    if (Is(Control::kSinumerik) && Chance(0.3))
      Line(fmt::format("S1={:.9f} M1={}", now_.rpm, sense + 1));
    else
      Line(fmt::format("S{:.9f} {}", now_.rpm, sense));
  }

  void Add(Want want, const Vector& p) {
    at_ = p;
    want.to = shift_ + Unit() * p;
    want.feed = want.kind == Kind::kRapid ? -1 : feed_;
    wants_.push_back(want);
    if (want.kind == Kind::kRapid) return;
    Cut();
    cut_ = true;
  }

  void SourceLocation() {
    const Vector p = Printed(random_.Vector(100 / Unit()));
    Line("G0 " + Words(p));
    Add({.kind = Kind::kRapid}, p);
  }

  void Step() {
    switch (random_.Below(8)) {
      case 0:
        Tool();
        if (Chance(0.5)) Spindle();
        return SourceLocation();
      case 1:
        return Preselect();
      case 2:
        Offset();
        return SourceLocation();
      case 3:
      case 4:
        return Arc();
      default:
        return Straight();
    }
  }

  // The next tool is named while this one cuts.
  void Preselect() {
    Line(fmt::format("T{}", 1 + random_.Below(3)));
    Straight();
  }

  void Offset() {
    constexpr std::array names{"G54", "G55", "G59", "G54.1 P3", "G500"};
    const std::string name = names[random_.Below(Is(Control::kSinumerik) ? 3 : 4)];
    Line(name);
    if (name == std::exchange(in_force_, name)) return;
    if (several_)
      shift_ = options_.offsets[name];
    else if (cut_)
      Refuse("a second zero offset");
  }

  void Straight() {
    const Vector p = Printed(random_.Vector(100 / Unit()));
    const double f = Printed(Between(50, 3000));
    feed_ = f * Unit() / 60;
    Line(fmt::format("G1 {} F{:.9f}", Words(p), f));
    Add({}, p);
  }

  // A helix of several turns: P counts those begun, TURN those that are whole.
  void Arc() {
    const double part = Between(0.1, 6), radius = Between(2, 20) / Unit();
    const auto turns = static_cast<int>(random_.Below(4));
    const bool left = Chance(0.5);
    const Vector about = left ? Vector::UnitZ() : Vector(-Vector::UnitZ());
    const Vector ij = Printed(Vector(radius * std::cos(part * 7), radius * std::sin(part * 7), 0));
    const Vector centre = at_ + ij, a = -ij;
    const Vector to = Printed(Vector(centre + std::cos(part) * a + std::sin(part) * about.cross(a) +
                                     Vector(0, 0, Between(-5, 5) / Unit())));
    std::string more;
    if (turns > 0 || Chance(0.3))
      more = Is(Control::kSinumerik) ? fmt::format(" TURN={}", turns) : fmt::format(" P{}", turns + 1);
    Line(fmt::format("{} {} I{:.9f} J{:.9f}{}", left ? "G3" : "G2", Words(to), ij.x(), ij.y(), more));
    Add({.kind = Kind::kArc,
         .to = {},
         .centre = shift_ + Unit() * centre,
         .about = about,
         .angle = part + 2 * kPi * turns},
        to);
  }

  Control control_;
  bool inch_ = false, several_ = false, cut_ = false;
  std::string in_force_;
  double feed_ = 0;
  Vector shift_ = Vector::Zero(), at_ = Vector::Zero();
};

template <class Dialect>
void ReadAll(uint64_t share) {
  uint64_t read = 0;
  const uint64_t count = std::max<uint64_t>(GeneratedCount() / share, 300);
  for (uint64_t i = 0; i < count; ++i) {
    read += Dialect(i).Check(i) ? 1 : 0;
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(read, count / 4) << "most files are refused";
  EXPECT_LT(read, count) << "no file is refused";
}

TEST(AptDialectGenerator, EachSendersWordsMeanWhatItMeansOrAreRefused) { ReadAll<AptDialect>(5); }

TEST(GcodeDialectGenerator, EachSendersWordsMeanWhatItMeansOrAreRefused) { ReadAll<GcodeDialect>(5); }

}  // namespace
}  // namespace millpose
