// SPDX-License-Identifier: GPL-3.0-or-later
// Random G-code written word by word by a writer that knows the points, and its reading: ISO with canned
// cycles, SINUMERIK with frames and tool vectors, Heidenhain's DIN/ISO.
#include <cmath>

#include "base/units.hpp"
#include "tests/toolpath/generated_paths.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
using Kind = Want::Kind;

CamReadOptions Machine() {
  CamReadOptions options;
  options.chord_tolerance = 0.02;
  options.rotary_axes =
      RotaryAxes({{'C', -Vector::UnitZ(), {10, 0, 0}, true}, {'B', Vector::UnitY(), {0, 0, 200}, false}});
  options.kinematics_codes = {{428, true}, {429, false}};
  return options;
}

// The machine above, by hand: a C table about (10, 0), a head that swivels in B 200 above the tip.
Vector AxisOf(double b, double c) {
  const Vector tool(std::sin(b), 0, std::cos(b));
  return {std::cos(c) * tool.x() - std::sin(c) * tool.y(), std::sin(c) * tool.x() + std::cos(c) * tool.y(),
          tool.z()};
}
Vector TipOf(const Vector& machine, double b, double c) {
  const Vector p = machine + Vector(-200 * std::sin(b), 0, 200 - 200 * std::cos(b)) - Vector(10, 0, 0);
  return Vector(std::cos(c) * p.x() - std::sin(c) * p.y(), std::sin(c) * p.x() + std::cos(c) * p.y(), p.z()) +
         Vector(10, 0, 0);
}

enum class Dialect : uint8_t { kIso, kSinumerik, kHeidenhain };

class GcodeWriter {
 public:
  GcodeWriter(uint64_t index, Dialect dialect) : random_(index, 79), dialect_(dialect) {}

  GeneratedPath Write() {
    Head();
    SwitchTip();
    Block("G0 X0 Y0 Z" + Number(at_.z()), {.kind = Kind::kRapid}, at_);
    const int motions = 3 + static_cast<int>(random_.Below(12));
    for (int i = 0; i < motions; ++i) {
      if (Chance(0.3)) Harmless();
      if (Chance(0.15)) Modes();
      Motion();
    }
    Line(dialect_ == Dialect::kHeidenhain ? "N99999999 %GENERATED G71" : "M30");
    text_ += dialect_ == Dialect::kHeidenhain ? "" : "X99\n";
    return {text_, wants_, holes_left_out_};
  }

 private:
  bool Chance(double share) { return random_.Chance(share); }
  double Between(double low, double high) { return random_.Between(low, high); }
  bool heidenhain() const { return dialect_ == Dialect::kHeidenhain; }
  bool sinumerik() const { return dialect_ == Dialect::kSinumerik; }

  std::string Number(double value) {
    std::string text = fmt::format("{:.9f}", value);
    if (Chance(0.2))
      while (text.ends_with('0')) text.pop_back();
    return (value >= 0 && (heidenhain() || Chance(0.1)) ? "+" : "") + text;
  }
  std::string Words(const std::string& letters, const Vector& v) {
    std::string text;
    for (size_t i = 0; i < 3; ++i)
      text += fmt::format("{}{}{}", letters[i], Number(v[static_cast<int>(i)]), Chance(0.5) ? " " : "");
    return text;
  }

  void Line(std::string line) {
    number_ += 10;
    if (heidenhain() ? line[0] != 'N' && line[0] != '%' : Chance(0.3))
      line = fmt::format("N{} {}", number_, line);
    if (Chance(0.1))
      for (char& c : line) c = static_cast<char>(std::tolower(c));
    if (heidenhain()) line += " *";
    if (Chance(0.1)) line += dialect_ == Dialect::kIso ? " (G1 X5)" : " ; G1 X5";
    text_ += line + (Chance(0.1) ? "\r\n" : "\n");
  }

  void Head() {
    at_ = Vector(0, 0, Printed(Between(20, 60)));
    if (heidenhain()) {
      Line("%GENERATED G71");
      Line("G30 G17 X+0 Y+0 Z-20");
      Line("G31 G90 X+100 Y+100 Z+0");
      Line("T1 G17 S5000");
    } else if (sinumerik()) {
      text_ += "%_N_GENERATED_MPF\n;$PATH=/_N_WKS_DIR\n";
      Line("G17 G90 G94 G710 G54 G40 G64");
      Line("T=\"MILL\" M6");
    } else {
      text_ += Chance(0.5) ? "%\nONONAME\n" : "%\nO0001 (GENERATED)\n";
      Line("G21 G17 G90 G94 G40 G49 G80");
      Line("T1 M6");
    }
  }

  // Tip programming by the control's own word, and rotary axes that stand.
  void SwitchTip() {
    if (Chance(0.4)) return;
    constexpr std::array words{"G43.4 H1", "TRAORI", "M128"};
    const bool linuxcnc = dialect_ == Dialect::kIso && Chance(0.3);
    Line(linuxcnc ? "M428" : words[static_cast<size_t>(dialect_)]);
    tip_ = true;
  }

  void Modes() {
    if (dialect_ == Dialect::kIso && Chance(0.3)) {
      inch_ = !inch_;
      Line(inch_ ? "G20" : "G21");
    } else if (!heidenhain() && Chance(0.4)) {
      plane_ = static_cast<int>(random_.Below(3));
      Line(fmt::format("G{}", 17 + plane_));
    } else if (Chance(0.5)) {
      incremental_ = !incremental_;
      Line(incremental_ ? "G91" : "G90");
    } else if (sinumerik()) {
      Frame();
    } else {
      feed_ = Printed(Between(100, 2000)) / 60;
      Line(fmt::format("{}G1 F{:.9f}", heidenhain() ? "" : "G94 ", feed_ * 60 / Unit()));
    }
  }

  void Frame() {
    const Vector shift = Printed(random_.Vector(50));
    Line(fmt::format("TRANS X{:.9f} Y{:.9f} Z{:.9f}", shift.x(), shift.y(), shift.z()));
    const double angle = Printed(Between(-180, 180));
    Line(fmt::format("AROT Z{:.9f}", angle));
    const Vector base = frame_ * at_;
    frame_ = Eigen::Translation3d(shift) * Eigen::AngleAxisd(angle * kPi / 180, Vector::UnitZ());
    at_ = frame_.inverse() * base;
    // The place in the new frame has more digits than are printed: state all of it anew.
    const bool steps = std::exchange(incremental_, false);
    Line("G90");
    Block("G0 " + Words("XYZ", Printed(at_)), {.kind = Kind::kRapid}, Printed(at_));
    if (steps) Line("G91");
    incremental_ = steps;
  }

  double Unit() const { return inch_ ? 25.4 : 1; }
  // What is printed for a place, and the place that this is.
  Vector Programmed(const Vector& to) const {
    return Printed(Vector((incremental_ ? Vector(to - at_) : to) / Unit()));
  }
  Vector Reached(const Vector& programmed) const {
    return incremental_ ? Vector(at_ + Unit() * programmed) : Vector(Unit() * programmed);
  }

  // `to` in programmed coordinates, mm.
  void Block(const std::string& line, Want want, const Vector& to) {
    if (!line.empty()) Line(line);
    want.to = tip_ ? Vector(frame_ * to) : TipOf(frame_ * to, b_, c_);
    want.axis = by_vector_ ? vector_ : AxisOf(b_, c_);
    at_ = to;
    wants_.push_back(want);
  }

  void Motion() {
    switch (random_.Below(8)) {
      case 0:
        return Straight(Kind::kRapid);
      case 1:
        return Turn();
      case 2:
        return heidenhain() ? Straight(Kind::kStraight) : Holes();
      case 3:
      case 4:
        return Arc();
      case 5:
        return sinumerik() ? ToolVector() : Straight(Kind::kStraight);
      default:
        return Straight(Kind::kStraight);
    }
  }

  void Straight(Kind kind) {
    const Vector words = Programmed(at_ + random_.Vector(40));
    std::string line = kind == Kind::kRapid ? "G0 " : "G01";
    if (!incremental_ && Chance(0.2)) {  // one axis alone
      Vector to = at_;
      to.x() = Reached(words).x();
      return Block(line + "X" + Number(words.x()), {.kind = kind}, to);
    }
    Block(line + Words("XYZ", words), {.kind = kind}, Reached(words));
  }

  // Rotary axes in a rapid of their own: the way is no cut.
  void Turn() {
    if (!(frame_.linear() - Eigen::Matrix3d::Identity()).isZero(1e-12)) return;
    const Vector words = Programmed(at_ + random_.Vector(10));
    b_ = Printed(Between(-90, 90)) * kPi / 180;
    c_ = Printed(Between(-180, 180)) * kPi / 180;
    by_vector_ = false;
    const bool steps = std::exchange(incremental_, false);
    const Vector to = Programmed(at_);
    if (steps) Line("G90");
    Block(fmt::format("G0 {} B{:.9f} C{:.9f}", Words("XYZ", to), b_ * 180 / kPi, c_ * 180 / kPi),
          {.kind = Kind::kRapid}, Reached(to));
    if (steps) Line("G91");
    incremental_ = steps;
    (void)words;
  }

  void ToolVector() {
    const Vector printed = Printed(Vector(random_.Vector(1) + Vector(0, 0, 1.5)));
    if (!tip_) return Straight(Kind::kStraight);
    const Vector words = Programmed(at_ + random_.Vector(40));
    vector_ = (frame_.linear() * printed).normalized();
    by_vector_ = true;
    Block(fmt::format("G1 {} A3={:.9f} B3={:.9f} C3={:.9f}", Words("XYZ", words), printed.x(), printed.y(),
                      printed.z()),
          {.kind = Kind::kStraight}, Reached(words));
  }

  void Arc() {
    const int k = 2 - plane_,
              u = plane_ == 0   ? 0
                  : plane_ == 1 ? 2
                                : 1,
              v = plane_ == 0   ? 1
                  : plane_ == 1 ? 0
                                : 2;
    const bool ccw = Chance(0.5);
    Vector about = Vector::Zero();
    about[k] = ccw ? 1 : -1;
    // Centre and end as they are printed.
    Vector offset = Vector::Zero();
    offset[u] = Between(-30, 30);
    offset[v] = Between(-30, 30);
    offset = Unit() * Printed(Vector(offset / Unit()));
    Vector centre = at_ + offset;
    if (heidenhain() && !incremental_) centre = Printed(centre);
    Vector a = at_ - centre;
    a[k] = 0;
    double angle = Between(0.05, 6.2);
    const bool whole = Chance(0.15) && !heidenhain();
    const double rise = Chance(0.3) ? Between(-4, 4) : 0;
    Vector to = centre + std::cos(angle) * a + std::sin(angle) * about.cross(a);
    if (whole) to = at_;
    to[k] = at_[k] + rise;
    const Vector words = whole && rise == 0 && !incremental_ ? Vector(at_ / Unit()) : Programmed(to);
    Vector reached = whole && rise == 0 ? at_ : Reached(words);
    if (whole && rise == 0) return;  // the start has more digits than are printed
    if (whole) angle = 2 * kPi;
    WriteArc(ccw ? "G3 " : "G2 ", words, centre, angle, {u, v});
    Want want{.kind = Kind::kArc};
    want.centre = Where(centre);
    want.about = Direction(about);
    want.angle = angle;
    if (whole) {
      reached[u] = at_[u];
      reached[v] = at_[v];
    }
    Block("", want, reached);
  }

  Vector Where(const Vector& p) const { return tip_ ? Vector(frame_ * p) : TipOf(frame_ * p, b_, c_); }
  Vector Direction(const Vector& d) const { return Where(at_ + d) - Where(at_); }

  void WriteArc(const std::string& g, const Vector& words, const Vector& centre, double& angle,
                const std::array<int, 2>& plane) {
    const std::string ijk = "IJK";
    const Vector from_start = Printed(Vector((centre - at_) / Unit()));
    const double radius = (centre - at_).norm() / Unit();
    const bool round = std::abs(angle - kPi) > 0.3 && angle < 5.9;  // well told by a radius
    if (heidenhain()) {
      const Vector pole = incremental_ ? from_start : Printed(centre);
      Line(fmt::format("I{}J{}", Number(pole.x()), Number(pole.y())));
      Line(g + Words("XYZ", words));
    } else if (sinumerik() && Chance(0.3)) {
      const std::string turns = Chance(0.5) ? " TURN=1" : "";
      if (!turns.empty()) angle += 2 * kPi;
      Line(fmt::format("{}{}{}=AC({:.9f}) {}=AC({:.9f}){}", g, Words("XYZ", words),
                       ijk[static_cast<size_t>(plane[0])], centre[plane[0]] / Unit(),
                       ijk[static_cast<size_t>(plane[1])], centre[plane[1]] / Unit(), turns));
    } else if (round && Chance(0.3)) {
      const double printed = angle < kPi ? radius : -radius;
      Line(g + Words("XYZ", words) +
           (sinumerik() ? fmt::format(" CR={:.12f}", printed) : fmt::format(" R{:.12f}", printed)));
    } else {
      Line(fmt::format("{}{}{}{} {}{}", g, Words("XYZ", words), ijk[static_cast<size_t>(plane[0])],
                       Number(from_start[plane[0]]), ijk[static_cast<size_t>(plane[1])],
                       Number(from_start[plane[1]])));
    }
  }

  void Holes() {
    // A tool within 0.1 degrees of the hole stands along it.
    const bool upright = plane_ == 0 && (by_vector_ ? vector_.z() : std::cos(b_)) >= 0.9999984769132877;
    if (plane_ != 0 || incremental_) return;
    sinumerik() ? SinumerikHoles(upright) : IsoHoles(upright);
  }

  // A rapid to the clearance, the strokes, a rapid to the level behind.
  void Hole(const Vector& xy, double clearance, const std::vector<double>& strokes, double retract,
            bool drilled) {
    const auto at = [&](double z) { return Vector(xy.x(), xy.y(), z); };
    if (!drilled) {
      ++holes_left_out_;
      at_ = at(retract);
      return;
    }
    Block("", {.kind = Kind::kRapid}, at(clearance));
    for (const double z : strokes) {
      Block("", {}, at(z));
      if (std::abs(z - strokes.back()) < 1e-9) break;
      Block("", {}, at(chips_ > 0 ? std::min(clearance, z + chips_) : clearance));
    }
    Block("", {}, at(clearance));
    if (retract > clearance) Block("", {.kind = Kind::kRapid}, at(retract));
  }

  static std::vector<double> Strokes(double top, double bottom, double step) {
    std::vector<double> strokes;
    for (double z = top - step; z > bottom + 1e-9; z -= step) strokes.push_back(z);
    strokes.push_back(bottom);
    return strokes;
  }

  void IsoHoles(bool upright) {
    constexpr std::array kinds{"G81", "G82", "G83", "G73", "G85", "G89", "G84", "G86", "G76"};
    const size_t kind = random_.Below(kinds.size());
    const double initial = at_.z(), r = Printed((at_.z() - Between(1, 10)) / Unit());
    const double bottom = Printed(r - Between(3, 25) / Unit()), q = Printed(Between(2, 9) / Unit());
    const bool pecks = kind == 2 || kind == 3, to_r = Chance(0.5);
    const Vector first = Programmed(at_ + random_.Vector(40));
    chips_ = kind == 3 ? 0.254 : 0;
    std::string line = fmt::format("{} {} X{:.9f} Y{:.9f} Z{:.9f} R{:.9f}", to_r ? "G99" : "G98", kinds[kind],
                                   first.x(), first.y(), bottom, r);
    if (pecks) line += fmt::format(" Q{:.9f}", q);
    if (kind == 1 || kind == 5) line += " P500";
    Line(line + " F100.");
    const double clear = Unit() * r, deep = Unit() * bottom;
    const auto strokes = pecks ? Strokes(clear, deep, Unit() * q) : std::vector{deep};
    const double level = to_r ? clear : std::max(initial, clear);
    Hole(Reached(first), clear, strokes, level, upright && kind < 6);
    const Vector second = Programmed(at_ + random_.Vector(40));
    Line(fmt::format("X{:.9f} Y{:.9f}", second.x(), second.y()));
    Hole(Reached(second), clear, strokes, level, upright && kind < 6);
    Line("G80");
    Line("G0");
    if (!upright || kind >= 6) Straight(Kind::kRapid);
  }

  void SinumerikHoles(bool upright) {
    constexpr std::array kinds{"CYCLE81", "CYCLE82", "CYCLE83", "CYCLE84", "CYCLE86"};
    const size_t kind = random_.Below(kinds.size());
    const double reference = Printed(at_.z() - Between(3, 10)), rtp = Printed(reference + Between(1, 40));
    const double sdis = Printed(Between(0.5, 3)), depth = Printed(Between(3, 25));
    const bool absolute = Chance(0.5);
    std::string arguments = fmt::format("{:.9f},{:.9f},{:.9f},", rtp, reference, sdis);
    arguments += absolute ? fmt::format("{:.9f},", reference - depth) : fmt::format(",{:.9f}", depth);
    const double bottom = absolute ? Printed(reference - depth) : reference - depth;
    std::vector<double> strokes{bottom};
    chips_ = 0;
    if (kind == 1) arguments += ",0.5,0,1,12";
    if (kind == 2) {
      const double first = Printed(depth / Between(2, 5));
      const bool swarf = Chance(0.5);
      arguments += fmt::format(",,{:.9f},0,,,,{}", first, swarf ? 1 : 0);
      chips_ = swarf ? 0 : 1;
      strokes = EvenHalves(reference, first, bottom);
    }
    const bool modal = Chance(0.6);
    const Vector xy = Programmed(at_ + random_.Vector(40));
    const double clear = reference + sdis, level = std::max(rtp, clear);
    const bool drilled = upright && kind < 3;
    if (modal) Line(fmt::format("MCALL {}({})", kinds[kind], arguments));
    Block(fmt::format("G0 X{:.9f} Y{:.9f}", xy.x(), xy.y()), {.kind = Kind::kRapid},
          Vector(xy.x(), xy.y(), at_.z()));
    if (!modal) Line(fmt::format("{}({})", kinds[kind], arguments));
    Hole(at_, clear, strokes, level, drilled);
    if (modal) Line("MCALL");
    if (!drilled) Straight(Kind::kRapid);
  }

  // Strokes of one length, the last two equal.
  static std::vector<double> EvenHalves(double reference, double stroke, double bottom) {
    std::vector<double> strokes{reference - stroke};
    while (strokes.back() > bottom + 1e-9) {
      const double rest = strokes.back() - bottom;
      if (rest > stroke && rest < 2 * stroke) strokes.push_back(strokes.back() - rest / 2);
      strokes.push_back(rest < 2 * stroke ? bottom : strokes.back() - stroke);
    }
    return strokes;
  }

  void Harmless() {
    static const std::array<std::vector<std::string>, 3> words{
        {{"G05 P10000", "G05 P0", "M8", "G8 P1", "G43 H1", "M123", "G61.1", "G187 P2", "(REMARK)",
          "M66 P1 L0", "/M9", "G4 P500"},
         {"MCALL", "MSG(\"X5 Y5\")", "CYCLE832(0.01,1,1)", "FFWON", "G642", "SOFT", "D1", "S5000 M3",
          "; REMARK", "_TOL=0.02", "G4 F0.5", "CYCLE800()", "STOPRE"},
         {"M3", "M126", "; REMARK", "G98 L1", "G40", "M120 LA20", "G28", "T2 G17 S100"}}};
    const auto& own = words[static_cast<size_t>(dialect_)];
    const std::string& word = own[random_.Below(own.size())];
    if (word[0] == ';' || word[0] == '/')
      text_ += word + "\n";
    else
      Line(word);
  }

  WriterRandom random_;
  Dialect dialect_;
  std::string text_;
  std::vector<Want> wants_;
  size_t holes_left_out_ = 0;
  int number_ = 0, plane_ = 0;
  bool tip_ = false, inch_ = false, incremental_ = false, by_vector_ = false;
  double b_ = 0, c_ = 0, feed_ = 0, chips_ = 0;
  Vector at_ = Vector::Zero(), vector_ = Vector::UnitZ();
  Eigen::Isometry3d frame_ = Eigen::Isometry3d::Identity();
};

void ReadAll(Dialect dialect, uint64_t seed) {
  for (uint64_t i = 0; i < GeneratedCount() / 3; ++i) {
    ExpectRead(GcodeWriter(3 * i + seed, dialect).Write(), Machine(), i);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(GcodeGenerator, IsoIsReadAsItIsMeant) { ReadAll(Dialect::kIso, 0); }
TEST(GcodeGenerator, SinumerikIsReadAsItIsMeant) { ReadAll(Dialect::kSinumerik, 1); }
TEST(GcodeGenerator, HeidenhainIsReadAsItIsMeant) { ReadAll(Dialect::kHeidenhain, 2); }

TEST(GcodeGenerator, EveryUnknownWordIsRefused) {
  for (uint64_t i = 0; i < GeneratedCount() / 10; ++i) {
    RandomStream random(i, 83);
    const auto dialect = static_cast<Dialect>(i % 3);
    const std::array<std::string, 4> words{RandomWord(random), RandomWord(random) + "=5",
                                           fmt::format("G{}", 850 + random.Below(100)),
                                           fmt::format("{}5", "EUVW"[random.Below(4)])};
    std::string word = words[static_cast<size_t>(random.Below(4))];
    if (dialect == Dialect::kHeidenhain) word += " *";
    ExpectUnknownRefused(GcodeWriter(i, dialect).Write().text, word, Machine(), random);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace millpose
