// SPDX-License-Identifier: GPL-3.0-or-later
// FANUC LS: positions are gathered first, then the statements that go to them.
#include <regex>
#include <sstream>

#include "tests/audit/program_axes.hpp"

namespace millpose::audit {
namespace {

using FanucFiles = std::map<std::string, std::string>;

/// P[n] of a file: words with their numbers, those of group 2 with "GP2_" before them.
std::map<int, Fields> FanucPositionsOf(const std::string& text) {
  static const std::regex record(R"(\nP\[(\d+)[^\]]*\]\{([^}]*)\};)");
  static const std::regex word(R"((GP2)|([A-Z][A-Z0-9]*)\s*=\s*([-+]?[0-9]*\.?[0-9]+)\s*(?:mm|deg))");
  const size_t begin = text.find("\n/POS");
  if (begin == std::string::npos) throw std::runtime_error("/POS is missing");
  const std::string positions = text.substr(begin);
  std::map<int, Fields> found;
  for (std::sregex_iterator it(positions.begin(), positions.end(), record), end; it != end; ++it) {
    const std::string body = (*it)[2];
    std::string group;
    Fields& fields = found[std::stoi((*it)[1])];
    for (std::sregex_iterator one(body.begin(), body.end(), word); one != end; ++one) {
      if ((*one)[1].matched)
        group = "GP2_";
      else
        fields[group + (*one)[2].str()] = std::stold((*one)[3]);
    }
  }
  return found;
}

/// A frame as W, P, R turn it: about the fixed X, Y, Z.
Matrix4 FanucFrame(const Fields& f, const char* const names[6]) {
  return FrameXyzAbc(f.at(names[0]), f.at(names[1]), f.at(names[2]), f.at(names[5]), f.at(names[4]),
                     f.at(names[3]));
}

class FanucRun {
 public:
  FanucRun(const FanucFiles& files, const Setup& setup)
      : files_(files), setup_(setup), axes_("fanuc", setup) {
    X_FC_ = setup.X_FT * ToolFrame(setup.fanuc_tool_axis);
  }

  std::vector<Target> Run(const std::string& name) {
    Go(name, 0);
    return std::move(targets_);
  }

 private:
  void Go(const std::string& name, int depth) {
    static const std::regex call(R"(^\s*\d*:\s*CALL (\w+) ;$)");
    static const std::regex element(R"(^\s*\d*:\s*PR\[\d+,([1-6])\]=\(?([-+]?[0-9.]+)\)? ;$)");
    static const std::regex frame(R"(^\s*\d*:\s*(UFRAME|UTOOL)\[\d+\]=PR\[\d+\] ;$)");
    static const std::regex motion(R"(^\s*\d*:\s*([LJ]) P\[(\d+)[^\]]*\].*;$)");
    if (depth > 8) throw std::runtime_error(name + ": calls nest too deep");
    const std::map<int, Fields> positions = FanucPositionsOf(files_.at(name));
    std::istringstream stream(files_.at(name));
    std::string text;
    for (int number = 1; std::getline(stream, text) && text != "/POS"; ++number) {
      std::smatch match;
      if (std::regex_match(text, match, call)) {
        if (files_.contains(match[1].str() + ".ls")) Go(match[1].str() + ".ls", depth + 1);
      } else if (std::regex_match(text, match, element)) {
        register_[match[1]] = std::stold(match[2]);
      } else if (std::regex_match(text, match, frame)) {
        SetFrame(match[1]);
      } else if (std::regex_match(text, match, motion)) {
        Move({name, number, text}, match[1] == "L", positions.at(std::stoi(match[2])));
      }
    }
  }

  void SetFrame(const std::string& what) {
    static const char* const names[6] = {"1", "2", "3", "4", "5", "6"};
    const Matrix4 X = FanucFrame(register_, names);
    if (what == "UFRAME")
      X_WorldP_ = X;
    else
      X_FC_ = Turn(2, 180 * kDegree) * X;  // the faceplate stands half a turn from the flange
  }

  void Move(const Line& line, bool straight, const Fields& fields) {
    static const char* const names[6] = {"X", "Y", "Z", "W", "P", "R"};
    for (const ControllerAxis& axis : axes_.named())
      if (fields.contains(axis.name)) axes_.Take(axis, fields.at(axis.name));
    if (fields.contains("J1")) {
      if (straight) throw std::runtime_error(line.file + ": a straight motion to joint angles");
      Angles angles;
      for (size_t i = 0; i < 6; ++i) angles[i] = fields.at("J" + std::to_string(i + 1)) * kDegree;
      targets_.push_back(axes_.AtAngles(line, OfArm(setup_, "fanuc", angles)));
      return;
    }
    const Matrix4 X_CT = Inverse(X_FC_) * setup_.X_FT;
    // Held frames hold the part where the cell has it.
    const Matrix4 X_WP =
        X_WorldP_ ? Matrix4(setup_.X_WB * Shift(0, 0, setup_.fanuc_height) * *X_WorldP_) : setup_.X_WP;
    const Matrix4 X_PT = axes_.FromBelieved(line, false) * X_WP * FanucFrame(fields, names) * X_CT;
    // Evenly about one axis, or Z of UTOOL on a great circle: docs/fanuc.md.
    targets_.push_back(
        {line.file, line.number, std::nullopt, X_PT,
         Turning{.even = true, .swivel = X_CT.block<3, 3>(0, 0).transpose() * Vector3::UnitZ()},
         axes_.Position(line)});
  }

  const FanucFiles& files_;
  const Setup& setup_;
  Axes axes_;
  Fields register_;
  std::optional<Matrix4> X_WorldP_;
  Matrix4 X_FC_;
  std::vector<Target> targets_;
};

}  // namespace

std::vector<Target> ReadFanuc(const std::map<std::string, std::string>& files, const Setup& setup) {
  std::vector<Target> whole;
  // The program that calls the others goes to most places.
  for (const auto& [name, text] : files) {
    if (!name.ends_with(".ls")) continue;
    std::vector<Target> targets;
    try {
      targets = FanucRun(files, setup).Run(name);
    } catch (const std::out_of_range&) {
      continue;  // a part, whose frames another one sets
    }
    if (targets.size() > whole.size()) whole = std::move(targets);
  }
  return whole;
}

}  // namespace millpose::audit
