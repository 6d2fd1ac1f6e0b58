// SPDX-License-Identifier: GPL-3.0-or-later
// What readers of all controllers' programs share: lines, how axes are counted, axes beside the arm's six.
#pragma once

#include <regex>

#include "tests/audit/kinematics.hpp"
#include "tests/audit/programs.hpp"

namespace millpose::audit {

using Fields = std::map<std::string, Real>;

struct Line {
  std::string file;
  int number;
  std::string text;
};

/// The controller's tool frame in T: its axis `name` lies along T's z, the others follow by cyclic exchange.
Matrix4 ToolFrame(const std::string& name);

inline Matrix4 Inverse(const Matrix4& X) { return X.inverse(); }

/// The arm's own angles of those that a controller's text gives (rad).
Angles OfArm(const Setup& setup, const std::string& controller, Angles angles);

/// What a controller makes of the words of its external axes.
class Axes {
 public:
  Axes(const std::string& controller, const Setup& setup)
      : setup_(setup), position_(setup.axes.size()), known_(setup.axes.size(), 0) {
    const auto found = setup.controller_axes.find(controller);
    if (found != setup.controller_axes.end()) axes_ = found->second;
    if (setup.axes.size() > axes_.size())
      throw std::runtime_error("controllers." + controller + " does not name all external axes");
  }

  const std::vector<ControllerAxis>& named() const { return axes_; }

  /// In mm or degrees.
  void Take(const ControllerAxis& axis, Real word) {
    position_[axis.axis] = word * (setup_.axes[axis.axis].rotary ? kDegree : 1);
    known_[axis.axis] = 1;
  }

  /// Takes the words of a line and returns it without them. `between` stands between name and number.
  std::string TakeFrom(const std::string& line, const std::string& between) {
    std::string rest = line;
    for (const ControllerAxis& axis : axes_) {
      const std::regex word("\\b" + axis.name + between + R"(([-+]?[0-9]*\.?[0-9]+))");
      std::smatch match;
      if (!std::regex_search(rest, match, word)) continue;
      Take(axis, std::stold(match[1]));
      rest = match.prefix().str() + " " + match.suffix().str();
    }
    return rest;
  }

  /// A target with the joints at `angles`.
  Target AtAngles(const Line& line, const Angles& angles) const {
    const Matrix4 X_WT = Moved(true, position_) * Tool(setup_, angles);
    return {line.file, line.number, angles, Inverse(PartNow()) * X_WT, {}, Position(line)};
  }

  /// From the cell's world, as the controller believes it to be with all axes that it counts in at 0, to the
  /// part: `turned` is what counts from a table of which it knows. What is believed to be the robot's base is
  /// where the base truly is.
  Matrix4 FromBelieved(const Line& line, bool turned) const {
    Position(line);
    std::vector<Real> coupled(position_.size(), 0);
    for (const ControllerAxis& axis : axes_)
      if (axis.coupled) coupled[axis.axis] = position_[axis.axis];
    Matrix4 believed = BelievedCarriage(coupled).inverse();
    if (turned) believed *= Moved(false, coupled);
    // All in W: base and part are moved from where they stand with the axes at 0.
    return Inverse(PartNow()) * Moved(true, position_) * believed;
  }

  const std::vector<Real>& Position(const Line& line) const {
    for (const char known : known_)
      if (!known)
        throw std::runtime_error(line.file + ":" + std::to_string(line.number) +
                                 ": where the external axes are has not been said");
    return position_;
  }

  /// The controller's rail moves as its own data say, whatever the cell's does.
  void OnRail(const Vector3& direction_W) { rail_ = direction_W; }

 private:
  Matrix4 Moved(bool robot, const std::vector<Real>& position) const {
    return position.empty() ? Matrix4(Matrix4::Identity())
                            : Carried(setup_, LastCarrier(setup_, robot), position);
  }
  Matrix4 PartNow() const { return Moved(false, position_) * setup_.X_WP; }
  Matrix4 BelievedCarriage(const std::vector<Real>& coupled) const {
    if (!rail_) return Moved(true, coupled);
    Vector3 way = Vector3::Zero();
    for (const ControllerAxis& axis : axes_)
      if (axis.coupled && setup_.axes[axis.axis].carries_robot) way += coupled[axis.axis] * *rail_;
    return Shift(way[0], way[1], way[2]);
  }

  const Setup& setup_;
  std::vector<ControllerAxis> axes_;
  std::vector<Real> position_;  ///< mm or rad
  std::vector<char> known_;
  std::optional<Vector3> rail_;
};

/// LS programs (FANUC): positions first, then the statements that go to them.
std::vector<Target> ReadFanuc(const std::map<std::string, std::string>& files, const Setup& setup);
/// RAPID (ABB).
std::vector<Target> ReadRapid(const std::map<std::string, std::string>& files, const Setup& setup);

}  // namespace millpose::audit
