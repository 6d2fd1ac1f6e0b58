// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_arcs.hpp"

#include "base/text.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

InputError Unreadable(const SourceLocation& place, const AptStatement& statement) {
  return {place, fmt::format("the motion \"{}\" cannot be read; known are GOTO, GODLTA, CIRCLE with a GOTO, "
                             "NURBS with KNOT and CNTRL, and "
                             "TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z)",
                             statement.major.text.substr(0, 40))};
}

}  // namespace

AptCircle ReadCircle(const AptStatement& statement, const AptSystem& system) {
  AptStatement plain = statement;
  AptCircle circle;
  const size_t words = plain.minors.size();
  const bool movarc = statement.major.text == "MOVARC";
  if (!movarc && words > 2 && plain.minors[words - 2].text == "TIMES") {
    const auto times = ParseNumber(plain.minors[words - 1].text);
    if (!times || *times < 1 || *times > 1000 || *times != std::floor(*times))
      throw InputError(plain.minors[words - 1].place, "TIMES needs a whole number from 1 to 1000");
    circle.full_turns = static_cast<int>(*times) - 1;
    plain.minors.resize(words - 2);
  }
  if (movarc && words > 2 && plain.minors[words - 2].text == "ANGLE") {
    const auto angle = ParseNumber(plain.minors[words - 1].text);
    if (!angle || !(*angle > 0 && *angle <= 360'000))
      throw InputError(plain.minors[words - 1].place, "ANGLE needs degrees above 0, at most 360000");
    circle.sweep = DegToRad(*angle);
    plain.minors.resize(words - 2);
  }
  const std::vector<double> v = Numbers(plain, 6, movarc ? 7 : 11);
  circle.centre = system.Placed({v[0], v[1], v[2]});
  circle.axis = system.Direction(v, 3, plain);
  if (v.size() > 6) circle.radius = system.unit * v[6];
  circle.clockwise = v.size() > 7;
  circle.place = statement.major.place;
  return circle;
}

std::pair<AptCircle, Eigen::Vector3d> ReadDriveMotion(const AptStatement& statement,
                                                      const AptSystem& system) {
  std::vector<double> circle, line;
  std::vector<double>* list = nullptr;
  for (const AptWord& word : statement.minors) {
    std::string_view text = word.text;
    for (const auto& [head, numbers] : {std::pair("(CIRCLE/", &circle), std::pair("(LINE/", &line)})
      if (text.starts_with(head)) {
        list = numbers;
        text.remove_prefix(std::string_view(head).size());
      }
    const bool last = text.ends_with(')');
    if (last) text.remove_suffix(1);
    while (text.starts_with(' ')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    const auto number = ParseNumber(std::string(text));
    const bool between = list == nullptr && (text == "ON" || text == "2" || text == "INTOF");
    if (!between && (list == nullptr || !number)) throw Unreadable(word.place, statement);
    if (!between) list->push_back(*number);
    if (last) list = nullptr;
  }
  if (statement.major.text != "TLON,GOFWD" || circle.size() != 4 || line.size() != 6)
    throw Unreadable(statement.major.place, statement);
  AptCircle arc;
  arc.centre = system.Placed({circle[0], circle[1], circle[2]});
  arc.radius = system.unit * circle[3];
  arc.place = statement.major.place;
  return {arc, system.Placed({line[3], line[4], line[5]})};
}

}  // namespace millpose
