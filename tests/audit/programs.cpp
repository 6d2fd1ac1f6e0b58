// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/programs.hpp"

#include <regex>
#include <set>
#include <sstream>

#include "tests/audit/program_axes.hpp"

namespace millpose::audit {
namespace {

Real At(const Fields& fields, const std::string& name, Real otherwise = 0) {
  const auto found = fields.find(name);
  return found == fields.end() ? otherwise : found->second;
}

/// KUKA's way to write axes and frames: names with digits (A1) need a blank before the number.
Fields KrlFields(const std::string& text) {
  static const std::regex field(R"(([A-Z][A-Z0-9]*)\s+([-+]?[0-9.]+))");
  Fields fields;
  for (std::sregex_iterator it(text.begin(), text.end(), field), end; it != end; ++it)
    fields[(*it)[1]] = std::stold((*it)[2]);
  return fields;
}

Matrix4 Frame(const Fields& f) {
  return FrameXyzAbc(At(f, "X"), At(f, "Y"), At(f, "Z"), At(f, "A"), At(f, "B"), At(f, "C"));
}

/// The lines of a file without comments, called files in place of their calls.
void Expand(const std::string& name, const std::map<std::string, std::string>& files,
            std::vector<Line>& lines, int depth) {
  if (depth > 8) throw std::runtime_error(name + ": calls nest too deep");
  static const std::regex call(R"(^\s*(?:N\d+\s+)?\"?([A-Za-z_][A-Za-z0-9_]*)\"?\s*(?:\(\s*\))?\s*$)");
  std::istringstream stream(files.at(name));
  std::string text;
  for (int number = 1; std::getline(stream, text); ++number) {
    text = text.substr(0, text.find(';'));
    std::smatch match;
    std::string called;
    if (std::regex_match(text, match, call))
      for (const char* extension : {".src", ".spf", ".mpf"})
        if (files.contains(match[1].str() + extension)) called = match[1].str() + extension;
    if (called.empty())
      lines.push_back({name, number, text});
    else
      Expand(called, files, lines, depth + 1);
  }
}

/// The program that reaches most files, with all that it calls.
std::vector<Line> Whole(const std::map<std::string, std::string>& files, const std::string& extension) {
  std::vector<Line> whole;
  size_t most = 0;
  for (const auto& [name, text] : files) {
    if (!name.ends_with(extension)) continue;
    std::vector<Line> lines;
    Expand(name, files, lines, 0);
    std::set<std::string> reached;
    for (const Line& line : lines) reached.insert(line.file);
    if (reached.size() <= most) continue;
    most = reached.size();
    whole = std::move(lines);
  }
  return whole;
}

Vector3 AxisOf(const std::string& name) { return Vector3::Unit(name.back() - 'x'); }

std::vector<Target> ReadKrl(const std::map<std::string, std::string>& files, const Setup& setup) {
  static const std::regex motion(R"(^\s*(?:PTP|LIN|SLIN|SPL|SPTP)\s*\{([^}]*)\}.*)");
  static const std::regex frame(R"(^\s*\$(BASE|TOOL)\s*=\s*\{([^}]*)\}.*)");
  static const std::regex table(R"(^\s*\$BASE\s*=\s*EK\s*\([^{]*\{([^}]*)\}.*)");
  static const std::regex start(R"(^\s*BAS\s*\(\s*#INITMOV.*)");
  Axes axes("krl", setup);
  Matrix4 X_WorldB = setup.krl_robot;  // with the external axes at 0
  if (setup.krl_rail) X_WorldB = setup.krl_rail->root * X_WorldB;
  const Matrix4 X_WWorld = setup.X_WB * Inverse(X_WorldB);
  if (setup.krl_rail)
    axes.OnRail((X_WWorld * setup.krl_rail->root).block<3, 3>(0, 0) * setup.krl_rail->direction);
  Matrix4 X_WorldP = Matrix4::Identity(), X_FC = Matrix4::Identity();
  bool on_table = false, stated = true;
  Fields last;  // of the last pose: what a target does not name stays
  std::vector<Target> targets;
  for (const Line& line : Whole(files, ".src")) {
    std::smatch match;
    if (std::regex_match(line.text, match, frame)) {
      const Matrix4 X = Frame(KrlFields(match[2]));
      if (match[1] == "TOOL") {
        X_FC = X;
        continue;
      }
      X_WorldP = X;
      on_table = false;
      stated = true;
    } else if (std::regex_match(line.text, match, table)) {
      if (!setup.krl_table)
        throw std::runtime_error(line.file + ": EK without controllers.krl.external_base");
      X_WorldP = *setup.krl_table * Frame(KrlFields(match[1]));
      on_table = stated = true;
    } else if (std::regex_match(line.text, start)) {
      stated = stated && !on_table;  // what $BASE follows is forgotten
    } else if (std::regex_match(line.text, match, motion)) {
      Fields fields = KrlFields(match[1]);
      for (const ControllerAxis& axis : axes.named())
        if (fields.contains(axis.name)) axes.Take(axis, fields.at(axis.name));
      if (fields.contains("A1")) {
        Angles angles;
        for (size_t i = 0; i < 6; ++i) angles[i] = fields.at("A" + std::to_string(i + 1)) * kDegree;
        targets.push_back(axes.AtAngles(line, OfArm(setup, "krl", angles)));
        last.clear();
        continue;
      }
      if (!stated)
        throw std::runtime_error(line.file + ":" + std::to_string(line.number) +
                                 ": $BASE is not stated again");
      fields.insert(last.begin(), last.end());
      last = fields;
      const Matrix4 X_CT = X_FC.inverse() * setup.X_FT;
      // LIN with $ORI_TYPE = #VAR: $TOOL_DIRECTION swivels, the tool turns about it (docs/krl.md).
      const Vector3 direction = X_CT.block<3, 3>(0, 0).transpose() * AxisOf(setup.krl_tool_direction);
      const Matrix4 X_PT = axes.FromBelieved(line, on_table) * X_WWorld * X_WorldP * Frame(fields) * X_CT;
      targets.push_back({line.file, line.number, std::nullopt, X_PT,
                         Turning{.even = false, .swivel = direction}, axes.Position(line)});
    }
  }
  return targets;
}

/// Words X, Y, Z, A, B, C as a frame.
Matrix4 Placed(const Fields& words, const std::string& rotation) {
  const Real a = At(words, "A") * kDegree, b = At(words, "B") * kDegree, c = At(words, "C") * kDegree;
  const Matrix4 place = Shift(At(words, "X"), At(words, "Y"), At(words, "Z"));
  if (rotation == "euler" || rotation == "orieuler") return place * Turn(2, a) * Turn(0, b) * Turn(2, c);
  if (rotation == "orirpy2") return place * Turn(0, a) * Turn(1, b) * Turn(2, c);
  return place * Turn(2, c) * Turn(1, b) * Turn(0, a);
}

/// The three angles run evenly: the tool is turned by them from `before` and then by `behind`.
Turning ByAngles(const Fields& words, const std::string& rotation, const Matrix4& before,
                 const Matrix4& behind) {
  return {.even = false,
          .angles = Vector3(At(words, "A"), At(words, "B"), At(words, "C")),
          .of_angles = [=](const Vector3& abc) -> Matrix3 {
            const Matrix4 turned = Placed({{"A", abc[0]}, {"B", abc[1]}, {"C", abc[2]}}, rotation);
            return (before * turned * behind).block<3, 3>(0, 0);
          }};
}

std::vector<Target> ReadSinumerik(const std::map<std::string, std::string>& files, const Setup& setup) {
  static const std::regex frame(R"(.*\$P_UIFR\[\d+\]\s*=\s*CTRANS\(([^)]*)\)\s*:\s*CROT\(([^)]*)\).*)");
  static const std::regex pair(R"(([XYZ])\s*,\s*([-+]?[0-9.]+))");
  static const std::regex axes(R"(\b(R?A[1-6]|[A-Z]+[1-6])\s*=\s*([-+]?[0-9.]+))");
  static const std::regex pose(R"(\b([XYZABC])\s*=?\s*([-+]?[0-9]*\.?[0-9]+))");
  Matrix4 X_BP = Matrix4::Identity();
  const Matrix4 X_CT = ToolFrame(setup.sinumerik_tool_axis).inverse();
  bool transformed = false;
  Fields modal;
  Axes external("sinumerik", setup);
  Angles angles{};  // as they are counted
  std::vector<Target> targets;
  for (const Line& line : Whole(files, ".mpf")) {
    std::smatch match;
    if (std::regex_match(line.text, match, frame)) {
      Real numbers[6] = {};
      for (int group : {1, 2}) {
        const std::string list = match[group];
        for (std::sregex_iterator it(list.begin(), list.end(), pair), end; it != end; ++it)
          numbers[3 * (group - 1) + (*it)[1].str()[0] - 'X'] = std::stold((*it)[2]);
      }
      // CROT turns about Z, then the new Y, then the new X.
      X_BP = FrameXyzAbc(numbers[0], numbers[1], numbers[2], numbers[5], numbers[4], numbers[3]);
      continue;
    }
    if (line.text.find("TRAORI") != std::string::npos) transformed = true;
    if (line.text.find("TRAFOOF") != std::string::npos) transformed = false;
    const std::string spoken = std::regex_replace(line.text, std::regex(R"("[^"]*")"), "");
    const std::string own = external.TakeFrom(spoken, R"(\s*=\s*)");
    std::string text = own.substr(0, own.find("STAT"));
    // The cell's words of the tool's angles are A, B, C from here on.
    for (size_t i = 0; transformed && i < setup.sinumerik_words.size(); ++i)
      text = std::regex_replace(text, std::regex("\\b" + setup.sinumerik_words[i] + "\\s*="),
                                std::string(1, "ABC"[i]) + "=");
    bool moved = false;
    if (transformed) {
      for (std::sregex_iterator it(text.begin(), text.end(), pose), end; it != end; ++it) {
        modal[(*it)[1]] = std::stold((*it)[2]);
        moved = true;
      }
      if (!moved && own == spoken) continue;
      const Matrix4 X_PC = Placed(modal, setup.sinumerik_rotation);
      const Matrix4 X_PF = external.FromBelieved(line, true) * setup.X_WB * X_BP;
      // Z of the tool frame on a great circle; where machine data decide, as docs/sinumerik.md says.
      Turning turning;
      if (!setup.sinumerik_turn_known) turning = ByAngles(modal, setup.sinumerik_rotation, X_PF, X_CT);
      turning.even = !setup.sinumerik_turn_known;
      turning.swivel = X_CT.block<3, 3>(0, 0).transpose() * Vector3::UnitZ();
      targets.push_back({line.file, line.number, std::nullopt, X_PF * X_PC * X_CT, std::move(turning),
                         external.Position(line)});
    } else {
      for (std::sregex_iterator it(text.begin(), text.end(), axes), end; it != end; ++it) {
        const auto axis = static_cast<size_t>((*it)[1].str().back() - '1');
        angles[axis] = std::stold((*it)[2]) * kDegree;
        moved = true;
      }
      if (moved || own != spoken)
        targets.push_back(external.AtAngles(line, OfArm(setup, "sinumerik", angles)));
    }
  }
  return targets;
}

/// Six joints, or, between the default texts that switch the kinematics, the tool in the robot's base.
std::vector<Target> ReadLinuxCnc(const std::map<std::string, std::string>& files, const Setup& setup) {
  static const std::regex comment(R"(\([^)]*\))");
  static const std::regex word(R"(([XYZABC])\s*([-+]?[0-9]*\.?[0-9]+))");
  const Matrix4 X_CT = ToolFrame(setup.linuxcnc_tool_axis).inverse();
  Axes external("linuxcnc", setup);
  bool cartesian = false;
  Fields joints, pose;
  std::vector<Target> targets;
  for (const Line& line : Whole(files, ".ngc")) {
    const std::string spoken = std::regex_replace(line.text, comment, "");
    if (spoken.starts_with("G10 ")) continue;  // sets an offset, moves nothing
    const std::string text = external.TakeFrom(spoken, R"(\s*)");
    if (text.starts_with("M68 E3")) cartesian = text.find("Q0") != std::string::npos;
    Fields& modal = cartesian ? pose : joints;
    bool moved = text != spoken;
    for (std::sregex_iterator it(text.begin(), text.end(), word), end; it != end; ++it) {
      modal[(*it)[1]] = std::stold((*it)[2]);
      moved = true;
    }
    if (!moved) continue;
    if (cartesian) {
      const Matrix4 X_PB = external.FromBelieved(line, true) * setup.X_WB;
      targets.push_back({line.file, line.number, std::nullopt,
                         X_PB * Placed(pose, setup.linuxcnc_rotation) * X_CT,
                         ByAngles(pose, setup.linuxcnc_rotation, X_PB, X_CT), external.Position(line)});
      continue;
    }
    Angles angles{};
    for (const auto& [name, value] : joints) angles[std::string("XYZABC").find(name)] = value * kDegree;
    targets.push_back(external.AtAngles(line, OfArm(setup, "linuxcnc", angles)));
  }
  return targets;
}

/// movej with joints, movep and movel with the tool in the robot's base: m, and axis times angle.
std::vector<Target> ReadUrScript(const std::map<std::string, std::string>& files, const Setup& setup) {
  static const std::regex motion(R"(^\s*move[jlp]\s*\(\s*(p?)\s*\[([^\]]*)\])");
  const Matrix4 X_CT = ToolFrame(setup.urscript_tool_axis).inverse();
  const Axes none("urscript", setup);
  std::vector<Target> targets;
  for (const Line& line : Whole(files, ".script")) {
    std::smatch match;
    if (!std::regex_search(line.text, match, motion)) continue;
    std::istringstream numbers(std::regex_replace(match[2].str(), std::regex(","), " "));
    Angles values{};
    for (size_t axis = 0; axis < values.size(); ++axis) numbers >> values[axis];
    if (match[1].length() == 0) {
      targets.push_back(none.AtAngles(line, OfArm(setup, "urscript", values)));
      continue;
    }
    const Vector3 turn(values[3], values[4], values[5]);
    Matrix4 X_BC = Shift(1000 * values[0], 1000 * values[1], 1000 * values[2]);
    if (turn.norm() > 0)
      X_BC.block<3, 3>(0, 0) = Eigen::AngleAxis<Real>(turn.norm(), turn.normalized()).toRotationMatrix();
    targets.push_back({line.file,
                       line.number,
                       std::nullopt,
                       none.FromBelieved(line, true) * setup.X_WB * X_BC * X_CT,
                       {},
                       {}});
  }
  return targets;
}

}  // namespace

std::vector<Target> ReadProgram(const std::string& controller,
                                const std::map<std::string, std::string>& files, const Setup& setup) {
  if (controller == "krl") return ReadKrl(files, setup);
  if (controller == "sinumerik") return ReadSinumerik(files, setup);
  if (controller == "linuxcnc") return ReadLinuxCnc(files, setup);
  if (controller == "urscript") return ReadUrScript(files, setup);
  if (controller == "fanuc") return ReadFanuc(files, setup);
  if (controller == "rapid") return ReadRapid(files, setup);
  throw std::runtime_error("programs/" + controller + ": no reader for this controller");
}

}  // namespace millpose::audit
