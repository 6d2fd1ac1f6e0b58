// SPDX-License-Identifier: GPL-3.0-or-later
// Random CLDATA files written word by word by a writer that knows the points, and their reading.
#include <cmath>

#include "base/error.hpp"
#include "base/units.hpp"
#include "tests/toolpath/generated_paths.hpp"
#include "tests/toolpath/path_check.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
using Kind = Want::Kind;
constexpr double kChord = 0.02;

class AptWriter {
 public:
  explicit AptWriter(uint64_t index) : random_(index, 71) {}

  GeneratedPath Write() {
    Line("PARTNO/GENERATED");
    if (Chance(0.3)) SetUnit();
    if (Chance(0.3)) Msys();
    Rapid();
    const int motions = 3 + static_cast<int>(random_.Below(12));
    for (int i = 0; i < motions; ++i) {
      if (Chance(0.3)) Harmless();
      if (Chance(0.3)) Feed();
      Motion();
    }
    Line("FINI");
    return {text_, wants_, holes_left_out_};
  }

 private:
  bool Chance(double share) { return random_.Chance(share); }
  double Between(double low, double high) { return random_.Between(low, high); }
  Vector RandomVector(double size) { return random_.Vector(size); }

  std::string Numbers(const Vector& v) {
    const std::string blank = Chance(0.2) ? "  " : "";
    return fmt::format("{3}{0:.9f},{3}{1:.9f}, {2:.9f}", v.x(), v.y(), v.z(), blank);
  }

  void Line(std::string line) {
    if (Chance(0.1))
      for (char& c : line) c = static_cast<char>(std::tolower(c));
    const size_t comma = line.find(',', 8);
    if (Chance(0.15) && comma != std::string::npos && line.find("PART") == std::string::npos)
      line.insert(comma + 1, "$\n   ");
    if (Chance(0.1)) line += " $$ a remark / GOTO/1,2,3";
    text_ += line + (Chance(0.1) ? "\r\n" : "\n");
  }

  void SetUnit() {
    const int which = static_cast<int>(random_.Below(3));
    unit_ = std::array{1.0, 25.4, 10.0}[static_cast<size_t>(which)];
    Line(std::array{"UNITS/MM", "UNITS/INCHES", "UNITS/CM"}[static_cast<size_t>(which)]);
  }

  void Msys() {
    const Vector origin = Printed(RandomVector(100 / unit_));
    const Vector x = Printed(Vector(RandomVector(1).normalized()));
    const Vector y = Printed(Vector(x.cross(RandomVector(1)).normalized()));
    Line(fmt::format("MSYS/{},{},{}", Numbers(origin), Numbers(x), Numbers(y)));
    origin_ = unit_ * origin;
    rotation_.col(0) = x.normalized();
    rotation_.col(2) = x.cross(y).normalized();
    rotation_.col(1) = rotation_.col(2).cross(rotation_.col(0));
    axis_ = Vector::UnitZ();
  }

  Vector Placed(const Vector& p) const { return origin_ + rotation_ * (unit_ * p); }

  // `p` in file coordinates.
  void Add(Want want, const Vector& p) {
    arriving_ = want.kind == Kind::kRapid ? Vector(Vector::Zero()) : Vector(p - at_);
    at_ = p;
    want.to = Placed(p);
    want.axis = rotation_ * axis_;
    want.feed = want.kind == Kind::kRapid ? -1 : feed_;
    wants_.push_back(want);
  }

  Vector NextPoint() { return Printed(Vector(at_ + RandomVector(50 / unit_))); }

  std::string MaybeAxis() {
    if (!Chance(0.3)) return "";
    const Vector axis = Printed(Vector(RandomVector(1) + Vector(0, 0, 1.5)));
    axis_ = axis.normalized();
    return "," + Numbers(axis);
  }

  void Rapid() {
    Line(Chance(0.5) ? "RAPID" : "RAPID/");
    const Vector p = NextPoint();
    Line("GOTO/" + Numbers(p) + MaybeAxis());
    Add({.kind = Kind::kRapid}, p);
  }

  void Motion() {
    switch (random_.Below(9)) {
      case 0:
        return Rapid();
      case 1:
        return Step();
      case 2:
        return Spline();
      case 3:
        return Holes();
      case 4:
        return Catia();
      case 5:
      case 6:
        return Circle();
      default:
        return Straight();
    }
  }

  void Straight() {
    const Vector p = NextPoint();
    Line("GOTO/" + Numbers(p) + MaybeAxis());
    Add({}, p);
  }

  void Step() {
    if (Chance(0.4)) {
      const double along = Printed(Between(-5, 5) / unit_);
      Line(fmt::format("GODLTA/{:.9f}", along));
      return Add({}, at_ + along * axis_);
    }
    const Vector step = Printed(RandomVector(20 / unit_));
    Line("GODLTA/" + Numbers(step));
    Add({}, at_ + step);
  }

  // An arc from where the tool is: centre, axis and end in file coordinates.
  struct Arc {
    Vector centre, about, to;
    double angle;
  };
  Arc RandomArc(int whole_turns, double rise) {
    Arc arc;
    arc.about = Printed(Vector(RandomVector(1).normalized()));
    const Vector unit = arc.about.normalized();
    const Vector radial = unit.cross(RandomVector(1)).normalized() * Between(0.2, 30) / unit_;
    arc.centre = Printed(Vector(at_ - radial));
    const Vector a = at_ - arc.centre - unit.dot(at_ - arc.centre) * unit;
    arc.angle = Between(0.02, 2 * kPi - 0.02);
    if (Chance(0.15)) arc.angle = kPi;
    if (Chance(0.15)) arc.angle = 2 * kPi;
    const Vector end =
        arc.angle == 2 * kPi ? a : Vector(std::cos(arc.angle) * a + std::sin(arc.angle) * unit.cross(a));
    arc.to = arc.centre + end + (unit.dot(at_ - arc.centre) + rise) * unit;
    if (arc.angle == 2 * kPi && rise == 0) arc.to = at_;
    arc.to = Printed(arc.to);
    arc.angle += 2 * kPi * whole_turns;
    return arc;
  }

  Want WantOf(const Arc& arc) const {
    return {.kind = Kind::kArc,
            .to = {},
            .centre = Placed(arc.centre),
            .about = rotation_ * arc.about.normalized(),
            .angle = arc.angle};
  }

  // Whether the cut before seems to go on the other way round: such a file would be refused.
  bool Contradicts(const Arc& arc) const {
    if (!(arriving_.norm() > 0)) return false;
    const Vector unit = arc.about.normalized();
    const Vector tangent = unit.cross(at_ - arc.centre).normalized();
    const Vector flat = arriving_ - unit.dot(arriving_) * unit;  // a helix leaves with a slope
    return flat.norm() > 0 && flat.normalized().dot(-tangent) > 0.7;
  }

  void Circle() {
    const bool nx = Chance(0.4);
    const int turns = nx && Chance(0.3) ? static_cast<int>(random_.Below(3)) : 0;
    const Arc arc = RandomArc(turns, Chance(0.3) ? Between(-3, 3) / unit_ : 0);
    if (Contradicts(arc)) return Straight();
    // The axis's sign: counter-clockwise in the plain form, clockwise in NX's.
    const Vector sign = nx ? Vector(-arc.about) : arc.about;
    const double radius = (at_ - arc.centre).norm();
    std::string line = fmt::format("CIRCLE/{},{}", Numbers(arc.centre), Numbers(sign));
    if (nx || Chance(0.7)) line += fmt::format(",{:.6f}", radius);
    if (nx) line += ",0.0600,0.5000,30.0000,0.0000";
    if (turns > 0) line += fmt::format(",TIMES,{}", turns + 1);
    Line(line);
    if (Chance(0.3)) Line("PAINT/COLOR,31");
    Line("GOTO/" + Numbers(arc.to));
    Go(arc, arc.to);
  }

  // Along the arc; the next circle may go on from its end.
  void Go(const Arc& arc, const Vector& to) {
    const Vector unit = arc.about.normalized(), from = at_;
    Add(WantOf(arc), to);
    arriving_ = arc.angle * unit.cross(to - arc.centre) + unit.dot(to - from) * unit;
  }

  // INDIRV says the direction, TLON the circle: in the plane of both.
  void Catia() {
    const Arc arc = RandomArc(0, 0);
    const bool whole = arc.angle == 2 * kPi;
    const Vector tangent = Printed(Vector(arc.about.normalized().cross(at_ - arc.centre).normalized()));
    Arc read = arc;  // the plane that the printed numbers span
    read.about = (at_ - arc.centre).cross(tangent);
    Line("INDIRV/" + Numbers(tangent));
    Line(fmt::format("TLON,GOFWD/ (CIRCLE/ {}, {:.9f}),ON,{}(LINE/ {},{})", Numbers(arc.centre),
                     (at_ - arc.centre).norm(), whole ? "2,INTOF," : "", Numbers(arc.centre),
                     Numbers(arc.to)));
    Go(read, arc.to);
  }

  void Spline() {
    const size_t degree = 1 + random_.Below(4), inner = random_.Below(4), count = degree + 1 + inner;
    std::vector<double> knots(degree + 1, 0.0);
    for (size_t i = 0; i < inner; ++i) {
      const bool again = degree > 1 && i > 0 && knots.back() > knots[knots.size() - 2] && Chance(0.2);
      knots.push_back(again ? knots.back() : knots.back() + Printed(Between(0.1, 1)));
    }
    // An inner knot may be there as often as the degree; here twice at most.
    const double last = knots.back() + 1;
    for (size_t i = 0; i <= degree; ++i) knots.push_back(last);
    std::vector<Vector> control{at_};
    std::vector<double> weights{1};
    const bool rational = Chance(0.5);
    for (size_t i = 1; i < count; ++i) {
      control.push_back(Printed(Vector(control.back() + RandomVector(8 / unit_))));
      weights.push_back(rational ? Printed(Between(0.3, 3)) : 1);
    }
    Line(fmt::format("NURBS/{},{},{}", degree + (Chance(0.5) ? 1 : 0), knots.size(), count));
    WriteKnots(knots);
    for (size_t i = 0; i < count; ++i)
      Line(rational ? fmt::format("CNTRL/{},{:.9f}", Numbers(control[i]), weights[i])
                    : "CNTRL/" + Numbers(control[i]));
    Want want{.kind = Kind::kCurve};
    want.curve = DenseSpline(control, weights, knots, degree);
    for (Vector& p : want.curve) p = Placed(p);
    Add(want, control.back());
    arriving_ = control.back() - control[count - 2];
  }

  void WriteKnots(const std::vector<double>& knots) {
    std::string line;
    for (const double u : knots) {
      line += fmt::format("{}{:.9f}", line.empty() ? "KNOT/" : ",", u);
      if (!Chance(0.3)) continue;
      Line(line);
      line.clear();
    }
    if (!line.empty()) Line(line);
  }

  void Holes() {
    const double clear = Printed(Between(1, 4) / unit_), depth = Printed(Between(3, 30) / unit_);
    const double retract = Printed(clear + Between(1, 9) / unit_), step = Printed(depth / Between(1.5, 6));
    const bool creo = Chance(0.5), deep = Chance(0.4), chips = deep && Chance(0.4);
    const bool tap = Chance(0.2);
    std::string line = tap    ? "CYCLE/TAP"
                       : creo ? (chips  ? "CYCLE/BRKCHP"
                                 : deep ? "CYCLE/DEEP"
                                        : "CYCLE/DRILL")
                              : (chips  ? "CYCLE/DRILL,BRKCHP"
                                 : deep ? "CYCLE/DRILL,DEEP"
                                        : "CYCLE/DRILL");
    line += creo ? fmt::format(",DEPTH,{:.9f},CLEAR,{:.9f}", depth, clear)
                 : fmt::format(",RAPTO,{:.9f},FEDTO,{:.9f},RTRCTO,{:.9f}", clear, -depth, retract);
    if (deep) line += fmt::format(",STEP,{:.9f}", step);
    Line(line + ",MMPM,120");
    for (int i = 0; i < 2; ++i)
      Hole(clear, depth, creo ? clear : retract, deep ? step : clear + depth, chips, tap);
    Line("CYCLE/OFF");
    if (tap) Rapid();
  }

  void Hole(double clear, double depth, double retract, double step, bool chips, bool tap) {
    const Vector p = NextPoint();
    Line("GOTO/" + Numbers(p));
    if (tap) {
      ++holes_left_out_;
      return;
    }
    const double feed = std::exchange(feed_, 2);
    const auto at = [&](double height) -> Vector { return p + height * axis_; };
    Add({.kind = Kind::kRapid}, at(clear));
    for (double z = clear - step;; z -= step) {
      const bool last = z <= -depth + 1e-9 / unit_;
      Add({}, at(last ? -depth : z));
      Add({}, at(chips && !last ? std::min(clear, z + 1 / unit_) : clear));
      if (last) break;
    }
    if (retract > clear) Add({.kind = Kind::kRapid}, at(retract));
    feed_ = feed;
    arriving_.setZero();
  }

  void Feed() {
    const double f = Printed(Between(50, 3000));
    switch (random_.Below(4)) {
      case 0:
        Line(fmt::format("FEDRAT/{:.9f},MMPM", f));
        feed_ = f / 60;
        break;
      case 1:
        Line(fmt::format("FEDRAT/MMPM,{:.9f}", f));
        feed_ = f / 60;
        break;
      case 2:
        Line(fmt::format("FEDRAT/{:.9f}", f));
        feed_ = f * unit_ / 60;
        break;
      default:
        Line("SPINDL/RPM,3000,CLW");
        Line(fmt::format("FEDRAT/{:.9f},MMPR", f / 1000));
        feed_ = Printed(f / 1000) * 50;
    }
  }

  void Harmless() {
    constexpr std::array words{"PAINT/COLOR,42",    "PPRINT OPERATION 7", "COOLNT/ON",
                               "MULTAX/ON",         "REMARK/A, B",        "OPSTOP",
                               "DELAY/2.0",         "CUTCOM/OFF",         "PREFUN/64",
                               "INSERT/M8 T4 (GO)", "SEQNO/100",          "$$-> REMARK / 1, 0, $\n 0, 1",
                               "TRACUT/NOMORE",     "AUXFUN/8",           "$$ GOTO/1,1,1"};
    text_ += std::string(words[random_.Below(words.size())]) + "\n";
  }

  WriterRandom random_;
  std::string text_;
  std::vector<Want> wants_;
  double unit_ = 1, feed_ = 0;
  Vector origin_ = Vector::Zero(), at_ = Vector::Zero(), axis_ = Vector::UnitZ(), arriving_ = Vector::Zero();
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  size_t holes_left_out_ = 0;
};

// The words of several senders in one file: where they differ they are NX's, and the unit is the job's.
CamReadOptions AsNx() {
  CamReadOptions options;
  options.sender = CamSender::kNx;
  options.unit = 1;
  return options;
}

TEST(AptGenerator, PathsAreReadAsTheyAreMeant) {
  CamReadOptions options = AsNx();
  options.chord_tolerance = kChord;
  for (uint64_t i = 0; i < GeneratedCount(); ++i) {
    const GeneratedPath path = AptWriter(i).Write();
    ExpectRead(path, options, i);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(AptGenerator, EveryUnknownWordIsRefused) {
  for (uint64_t i = 0; i < GeneratedCount() / 10; ++i) {
    RandomStream random(i, 73);
    ExpectUnknownRefused(AptWriter(i).Write().text, RandomWord(random) + "/1,2", AsNx(), random);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace millpose
