// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/krl_values.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/angles.hpp"
#include "base/units.hpp"

namespace millpose::campaign {

Fields FieldsOf(Cursor& at, std::initializer_list<const char*> types) {
  at.Need(at.TakeChar('{'), "{");
  const Cursor start = at;
  const std::string type = at.Name();
  bool typed = false;
  for (const char* known : types) typed = typed || type == known;
  if (!typed || !at.TakeChar(':')) at = start;
  Fields fields;
  do {
    const std::string name = at.Name();
    const auto bits = at.Bits();
    const auto value = bits ? std::optional<double>(*bits) : at.Number(true);
    at.Need(!name.empty() && value.has_value(), "a field with its value");
    if (!fields.emplace(name, *value).second) throw Refusal{"a field twice: " + name};
  } while (at.TakeChar(','));
  at.Need(at.TakeChar('}'), "}");
  return fields;
}

void Allow(const Fields& fields, const std::string& letters, bool target) {
  for (const auto& [name, value] : fields) {
    const bool letter = name.size() == 1 && letters.find(name[0]) != std::string::npos;
    const bool extra = target && (name == "S" || name == "T" ||
                                  (name.size() == 2 && name[0] == 'E' && name[1] >= '1' && name[1] <= '6'));
    if (!letter && !extra) throw Refusal{"no such field: " + name};
  }
}

Pose PoseOf(const Fields& f) {
  return Frame(f.at("X"), f.at("Y"), f.at("Z"), Zyx(f.at("A"), f.at("B"), f.at("C")));
}

namespace {

Pose WholeFrame(const Fields& fields) {
  Allow(fields, "XYZABC", false);
  for (const char* name : {"X", "Y", "Z", "A", "B", "C"})
    if (!fields.contains(name)) throw Refusal{"an incomplete frame"};
  return PoseOf(fields);
}

}  // namespace

Pose FrameLiteral(Cursor& at) {
  const Fields fields = FieldsOf(at, {"FRAME"});
  at.Need(at.Done(), "the end of the line");
  return WholeFrame(fields);
}

std::optional<Pose> MovingBase(Cursor& at, bool coupled) {
  at.Need(at.TakeChar('('), "(");
  bool known = coupled;
  for (const char* part : {".ROOT", ".MECH_TYPE"}) {
    at.Need(at.Take("MACHINE_DEF") && at.TakeChar('['), "MACHINE_DEF[");
    const auto number = at.Number();
    at.Need(number.has_value() && at.TakeChar(']'), "a number and ]");
    known = known && *number == 2;
    at.Need(at.Take(part) && at.TakeChar(','), part);
  }
  const Fields fields = FieldsOf(at, {"FRAME"});
  at.Need(at.TakeChar(')') && at.Done(), ")");
  const Pose frame = WholeFrame(fields);
  return known ? std::optional(frame) : std::nullopt;
}

std::string Canonical(Cursor& at) {
  std::string text;
  while (!at.Done()) {
    if (const auto number = at.Number(true)) {
      text += fmt::format("{:.4f} ", *number + 0.0);
    } else if (const std::string name = at.Name(); !name.empty()) {
      text += name + " ";
    } else {
      const char c = at.Peek();
      if (std::string("{},:#").find(c) == std::string::npos) throw Refusal{"a value expected"};
      at.TakeChar(c);
      text += c;
    }
  }
  return text;
}

void KrlVariables::Declare(Cursor& at) {
  const std::string type = at.Name(), name = at.Name();
  at.Need(!type.empty() && !name.empty(), "a type and a name");
  if (at.TakeChar('[')) at.Need(at.Number().has_value() && at.TakeChar(']'), "a length and ]");
  at.Need(at.Done(), "the end of the line");
  if (!types_.emplace(name, type).second) throw Refusal{name + " is declared twice"};
}

bool KrlVariables::Assign(Cursor& at, const Pose& controllers) {
  const Cursor start = at;
  const std::string name = at.Name();
  if (!types_.contains(name)) {
    at = start;
    return false;
  }
  if (at.TakeChar('[')) at.Need(at.Number().has_value() && at.TakeChar(']'), "a number and ]");
  at.Need(at.TakeChar('=') && !at.Done(), "= and a value");
  if (types_.at(name) != "FRAME") {
    at.Rest();
  } else if (at.Peek() == '{') {
    frames_[name] = FrameLiteral(at);
  } else {  // "Geometric operator": frames one behind the other
    Pose pose = Term(at, controllers);
    while (at.TakeChar(':')) pose = pose * Term(at, controllers);
    at.Need(at.Done(), "the end of the line");
    frames_[name] = pose;
  }
  return true;
}

Pose KrlVariables::Term(Cursor& at, const Pose& controllers) const {
  const std::string name = at.Name();
  if (name == "INV_POS") {
    at.Need(at.TakeChar('('), "(");
    const Pose pose = Term(at, controllers);
    at.Need(at.TakeChar(')'), ")");
    return pose.inverse();
  }
  if (name == "$ROBROOT" || name == "$ERSYSROOT") return controllers;
  if (!frames_.contains(name)) throw Refusal{"a frame without a value: " + name};
  return frames_.at(name);
}

bool KrlVariables::Holds(Cursor& at) const {
  bool holds = false;
  do {
    at.Need(at.TakeChar('(') && at.Take("ABS") && at.TakeChar('('), "(ABS(");
    const std::string name = at.Name();  // NAME.X
    at.Need(name.size() > 2 && name[name.size() - 2] == '.', "a field of a frame");
    const auto frame = frames_.find(name.substr(0, name.size() - 2));
    if (frame == frames_.end()) throw Refusal{"a frame without a value: " + name};
    at.Need(at.TakeChar(')') && at.TakeChar('>'), ")>");
    const auto bound = at.Number(true);
    at.Need(bound.has_value() && at.TakeChar(')'), "a number and )");
    const Eigen::Vector3d p = frame->second.translation();
    const Eigen::Vector3d abc = AnglesZyx(frame->second.linear()) * kDegPerRad;
    const size_t field = std::string("XYZABC").find(name.back());
    if (field == std::string::npos) throw Refusal{"no such field: " + name};
    const double value = field < 3 ? p[static_cast<int>(field)] : abc[static_cast<int>(field) - 3];
    holds = holds || std::abs(value) > *bound;
  } while (at.Take("OR"));
  at.Need(at.Take("THEN") && at.Done(), "THEN");
  return holds;
}

}  // namespace millpose::campaign
