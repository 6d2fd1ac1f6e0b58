// SPDX-License-Identifier: GPL-3.0-or-later
// Reads SINUMERIK programs as far as robot programs of millpose and the usual hand edits go.
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/reader.hpp"
#include "program/sinumerik.hpp"

namespace millpose {
namespace {

constexpr const char* kTransformation = "TRAORI or TRAFOOF";
constexpr const char* kFrame = "$P_UIFR[1]";
constexpr double kSamePlace = 1e-9;  // of a frame stated again

/// What one block programs.
struct Block {
  std::array<std::optional<double>, 6> pose;  ///< X, Y, Z mm, A, B, C degrees
  std::array<std::optional<double>, 6> axes;  ///< degrees
  std::optional<int> status, turn;
  bool exact = false;
  bool dwell = false;

  bool HasPose() const {
    return std::any_of(pose.begin(), pose.end(), [](const auto& word) { return word.has_value(); });
  }
  bool HasAxes() const {
    return std::any_of(axes.begin(), axes.end(), [](const auto& word) { return word.has_value(); });
  }
};

class SinumerikReader : public ProgramReader {
 public:
  SinumerikReader(const ProgramFiles& files, const PostSettings& settings)
      : ProgramReader(files, settings, Templates(SinumerikTexts(), settings.texts, settings.tool_name)) {}

 private:
  std::vector<std::string> Needed() const override {
    return {"G40", "G54", "G90", "G94", "G642", "G710", "ORIWKS", kTransformation};
  }

  void Forgotten() override {
    tolerances_.reset();
    feed_ = 0;
    last_ = {};
  }

  void ReadCode(LineScanner& scan) override {
    AcceptAddress(scan, 'N');
    Block block;
    while (!scan.AtEnd()) {
      if (InText() && ReadTextWord(scan)) continue;
      if (!ReadMove(scan, block) && !ReadStatement(scan, block)) ReadName(scan);
    }
    if (block.HasAxes()) {
      AddAxes(scan, block);
    } else if (block.HasPose()) {
      AddPose(scan, block);
    }
  }

  /// A label or the call of a sub-program.
  void ReadName(LineScanner& scan) {
    const size_t start = scan.Next();
    const auto name = scan.AcceptName();
    if (name && scan.Accept(":")) return AddLabel(scan, start, *name);
    if (name && IsDeclared(*name)) {
      if (scan.Accept("(")) SkipArguments(scan);
      ReadDeclaredCall(scan, start, *name);
      return scan.ExpectEnd();
    }
    const char* message = "a word of a milling program or the call of a file of the program expected";
    if (!name) scan.Fail(message);
    if (!scan.AtEnd() || !ReadCall(scan, *name)) scan.FailFrom(start, message);
  }

  /// Spindle, coolant, outputs: what a text of the cell may switch.
  bool ReadTextWord(LineScanner& scan) override {
    for (const std::string_view word : {"M3", "M4", "M5", "M7", "M8", "M9", "STOPRE"}) {
      if (scan.Accept(word)) return true;
    }
    if (scan.Accept("$A_OUT") || scan.Accept("$A_OUTA")) {
      scan.Expect("[");
      scan.ExpectNumber();
      scan.Expect("]");
      scan.Expect("=");
      scan.ExpectNumber();
      return true;
    }
    return AcceptAddress(scan, 'S').has_value();
  }

  /// A letter directly followed by a number (X1.5) or by '=' and a number (A=1.5).
  static std::optional<double> AcceptAddress(LineScanner& scan, char letter) {
    if (!scan.AcceptAddress(letter)) return std::nullopt;
    scan.Accept("=");
    return scan.ExpectNumber();
  }

  bool ReadMove(LineScanner& scan, Block& block) {
    for (int i = 0; i < 6; ++i) {
      if (scan.Accept(settings_.axis_names[i])) {
        scan.Expect("=");
        block.axes[i] = scan.ExpectNumber();
        return true;
      }
    }
    for (int i = 0; i < 6; ++i) {
      if (const auto value = AcceptAddress(scan, "XYZABC"[i])) {
        if (block.pose[i]) scan.Fail(fmt::format("{} is given twice", "XYZABC"[i]));
        block.pose[i] = value;
        return true;
      }
    }
    if (scan.Accept("STAT=")) {
      block.status = scan.ExpectBits();
    } else if (scan.Accept("TU=")) {
      block.turn = scan.ExpectBits();
    } else if (scan.Accept("PTP")) {
      ptp_ = true;
    } else if (scan.Accept("CP")) {
      ptp_ = false;
    } else {
      return false;
    }
    return true;
  }

  bool ReadStatement(LineScanner& scan, Block& block) {
    const size_t start = scan.Next();
    if (scan.Accept("TRAORI")) {
      transformed_ = true;
      Stated(kTransformation);
    } else if (scan.Accept("TRAFOOF")) {
      transformed_ = false;
      Stated(kTransformation);
    } else if (scan.Accept("CYCLE832")) {
      ReadTolerances(scan);
    } else if (scan.Accept("MSG")) {
      ReadMessage(scan);
    } else if (scan.Accept("WHEN TRUE DO")) {
      ReadOutput(scan);
    } else if (scan.Accept("$P_UIFR[1]")) {
      ReadFrame(scan);
    } else if (scan.Accept("T=\"")) {
      const auto tool = scan.AcceptName();
      if (tool != settings_.tool_name) scan.Fail(fmt::format("tool {} expected", settings_.tool_name));
      scan.Expect("\"");
    } else if (scan.Accept("ORIWKS")) {
      Stated("ORIWKS");
    } else if (const auto feed = AcceptAddress(scan, 'F')) {
      if (!block.dwell) feed_ = *feed / 60;
    } else if (const auto g = AcceptAddress(scan, 'G')) {
      ReadG(scan, *g, start, block);
    } else if (const auto m = AcceptAddress(scan, 'M')) {
      if (*m == (InSubprogram() ? 17 : 30)) {
        EndFile();
      } else if (*m != 6 && *m != 0 && *m != 1) {
        scan.FailFrom(start, fmt::format("M0, M1, M6 or M{} expected (spindle and coolant: the cell's texts)",
                                         InSubprogram() ? 17 : 30));
      }
    } else {
      return AcceptAddress(scan, 'D').has_value();
    }
    return true;
  }

  /// CYCLE832(0.01,_FINISH,0.01): mm and degrees; with _OFF the machine data hold, which nobody knows here.
  void ReadTolerances(LineScanner& scan) {
    scan.Expect("(");
    const double position = scan.ExpectNumber();
    scan.Expect(",");
    const bool off = scan.Accept("_OFF");
    if (!off) scan.Expect("_FINISH");
    scan.Expect(",");
    const double orientation = scan.ExpectNumber() * kRadPerDeg;
    scan.Expect(")");
    tolerances_.reset();
    if (!off) tolerances_ = {position, orientation};
  }

  void ReadG(const LineScanner& scan, double g, size_t start, Block& block) {
    static const std::vector<double> allowed = {17, 40, 54, 90, 94, 642, 710};
    Stated(fmt::format("G{}", g));
    if (g == 0 || g == 1) {
      rapid_ = g == 0;
    } else if (g == 9) {
      block.exact = true;
    } else if (g == 4) {
      block.dwell = true;
    } else if (std::find(allowed.begin(), allowed.end(), g) == allowed.end()) {
      scan.FailFrom(start, "G0, G1, G4, G9, G17, G40, G54, G90, G94, G642 or G710 expected");
    }
  }

  void ReadMessage(LineScanner& scan) {
    scan.Expect("(");
    if (scan.Accept(")")) return;
    scan.Expect("\"");
    const bool begin = !InText() && scan.Accept("PASS");
    if (begin || (!InText() && scan.Accept("END OF PASS"))) ReadPassMark(scan, begin);
    while (scan.Peek() != '"' && scan.Peek() != '\0') scan.Skip();
    scan.Expect("\"");
    scan.Expect(")");
  }

  void ReadOutput(LineScanner& scan) {
    PathOutput output;
    scan.Expect("$A_OUT");
    scan.Expect("[");
    output.number = static_cast<int>(scan.ExpectNumber());
    scan.Expect("]");
    scan.Expect("=");
    output.on = scan.ExpectNumber() != 0;
    AddOutput(output);
  }

  Eigen::Vector3d ReadTriple(LineScanner& scan, std::string_view function) {
    scan.Expect(function);
    scan.Expect("(");
    Eigen::Vector3d values;
    for (int i = 0; i < 3; ++i) {
      if (i) scan.Expect(",");
      scan.Expect(std::string(1, "XYZ"[i]));
      scan.Expect(",");
      values[i] = scan.ExpectNumber();
    }
    scan.Expect(")");
    return values;
  }

  void ReadFrame(LineScanner& scan) {
    const size_t start = scan.Next();
    scan.Expect("=");
    Pose X_BP = Pose::Identity();
    X_BP.translation() = ReadTriple(scan, "CTRANS");
    scan.Expect(":");
    X_BP.linear() = FromAnglesZyx(ReadTriple(scan, "CROT").reverse() * kRadPerDeg);
    if (posed_ && program_.X_BP && !X_BP.matrix().isApprox(program_.X_BP->matrix(), kSamePlace))
      scan.FailFrom(start, "one frame for all poses of the program expected");
    program_.X_BP = X_BP;
    Stated(kFrame);
  }

  void AddAxes(const LineScanner& scan, const Block& block) {
    if (transformed_)
      scan.Fail("axes cannot be moved by themselves while TRAORI holds: TRAFOOF expected before");
    if (!rapid_) scan.Fail("axes are moved with G0 here, G1");
    Joints angles;
    for (int i = 0; i < 6; ++i) {
      if (!block.axes[i]) scan.Fail(fmt::format("{} is missing", settings_.axis_names[i]));
      angles[i] = *block.axes[i] * kRadPerDeg;
    }
    Motion& motion = AddMotion(MotionType::kJoint);
    motion.q = FromController(settings_.axes, angles);
    motion.exact = true;
    last_ = {};
  }

  void AddPose(const LineScanner& scan, const Block& block) {
    posed_ = true;
    Require(kFrame);
    if (!transformed_) scan.Fail("a pose can only be approached while TRAORI holds");
    for (int i = 0; i < 6; ++i) {
      if (block.pose[i]) last_[i] = block.pose[i];
      if (!last_[i]) scan.Fail(fmt::format("{} is missing", "XYZABC"[i]));
    }
    if (rapid_ && !ptp_) scan.Fail("G0 without PTP: the path to the pose is not defined; PTP expected");
    Motion& motion = AddMotion(ptp_ ? MotionType::kJoint : MotionType::kLinear);
    motion.X_PT.translation() = Eigen::Vector3d(*last_[0], *last_[1], *last_[2]);
    const Eigen::Vector3d abc(*last_[3], *last_[4], *last_[5]);
    motion.X_PT.linear() = FromToolAngles(settings_.rotation, abc * kRadPerDeg) * settings_.R_TC.transpose();
    motion.exact = ptp_ || block.exact;
    if (ptp_) {
      motion.status = block.status;
      motion.turn = block.turn;
    } else {
      if (feed_ <= 0) scan.Fail("G1 needs F");
      motion.feed = feed_;
      if (motion.exact) return;
      if (!tolerances_) scan.Fail("a CYCLE832 with the tolerances of rounded corners expected before");
      motion.blend = tolerances_->position;
      motion.angle_blend = tolerances_->orientation;
    }
  }

  std::array<std::optional<double>, 6> last_;  // X, Y, Z, A, B, C as they hold
  double feed_ = 0;                            // mm/s
  struct Tolerances {
    double position, orientation;  // mm, rad
  };
  std::optional<Tolerances> tolerances_;  // of rounded corners
  bool transformed_ = false, rapid_ = true, ptp_ = false;
  bool posed_ = false;  // a pose was approached
};

}  // namespace

std::vector<Problem> SinumerikPost::CheckTexts(const Arm&, const PostSettings& settings) const {
  return SinumerikReader({}, settings).CheckTexts();
}

MotionProgram SinumerikPost::Read(const ProgramFiles& files, const Arm&, const PostSettings& settings) const {
  return SinumerikReader(files, settings).Read({".mpf", ".spf"});
}

}  // namespace millpose
