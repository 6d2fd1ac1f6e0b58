// SPDX-License-Identifier: GPL-3.0-or-later
// G-code in the dialects of its controls.
#include <cmath>

#include "base/units.hpp"
#include "tests/toolpath/dialect_writer.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
using Kind = Want::Kind;

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

TEST(GcodeDialectGenerator, EachSendersWordsMeanWhatItMeansOrAreRefused) { ReadAll<GcodeDialect>(5); }

}  // namespace
}  // namespace millpose
