// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/runner.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cstdlib>
#include <regex>

#include "base/units.hpp"

namespace millpose::campaign {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool IsWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// The joint angles of a branch with the signs of T, each within a full revolution.
std::optional<Joints> WithSigns(const Arm& arm, const Pose& X_BF, int status, int turn) {
  const InverseResult inverse = Inverse(arm, X_BF);
  for (int s = 0; s < inverse.count; ++s) {
    if (inverse.solutions[s].branch != status) continue;
    Joints q = inverse.solutions[s].q;
    for (int i = 0; i < 6; ++i) {
      const bool negative = (turn >> i & 1) != 0;
      if (negative && q[i] > 0) q[i] -= 2 * kPi;
      if (!negative && q[i] < 0) q[i] += 2 * kPi;
    }
    return q;
  }
  return std::nullopt;
}

}  // namespace

void Cursor::Blanks() {
  while (at_ < line_.size() && IsBlank(line_[at_])) ++at_;
}

bool Cursor::Done() {
  Blanks();
  return at_ == line_.size();
}

bool Cursor::AtBlank() const { return at_ < line_.size() && IsBlank(line_[at_]); }

char Cursor::Peek() { return Done() ? '\0' : line_[at_]; }

bool Cursor::Take(std::string_view text) {
  Blanks();
  if (line_.compare(at_, text.size(), text) != 0) return false;
  const size_t end = at_ + text.size();
  if (IsWord(text.back()) && end < line_.size() && IsWord(line_[end])) return false;
  at_ = end;
  return true;
}

bool Cursor::TakeChar(char c) {
  if (Peek() != c) return false;
  ++at_;
  return true;
}

std::optional<double> Cursor::Number(bool exponent) {
  Blanks();
  size_t end = at_;
  if (end < line_.size() && (line_[end] == '-' || line_[end] == '+')) ++end;
  size_t digits = 0;
  for (; end < line_.size() && IsDigit(line_[end]); ++end) ++digits;
  if (end < line_.size() && line_[end] == '.') {
    for (++end; end < line_.size() && IsDigit(line_[end]); ++end) ++digits;
  }
  if (digits == 0) return std::nullopt;
  if (exponent && end < line_.size() && line_[end] == 'E') {
    size_t next = end + 1;
    if (next < line_.size() && (line_[next] == '-' || line_[next] == '+')) ++next;
    if (next < line_.size() && IsDigit(line_[next])) {
      while (next < line_.size() && IsDigit(line_[next])) ++next;
      end = next;
    }
  }
  if (end < line_.size() && line_[end] == '.') return std::nullopt;  // a second point
  const double value = std::strtod(line_.substr(at_, end - at_).c_str(), nullptr);
  at_ = end;
  return value;
}

std::optional<int> Cursor::Bits() {
  Blanks();
  if (line_.compare(at_, 2, "'B") != 0) return std::nullopt;
  size_t end = at_ + 2;
  int value = 0;
  for (; end < line_.size() && (line_[end] == '0' || line_[end] == '1'); ++end)
    value = (value << 1 | (line_[end] - '0')) & 0xffff;
  if (end == at_ + 2 || end == line_.size() || line_[end] != '\'') return std::nullopt;
  at_ = end + 1;
  return value;
}

std::string Cursor::Name() {
  Blanks();
  size_t end = at_;
  while (end < line_.size() && (IsWord(line_[end]) || line_[end] == '.')) ++end;
  const std::string name = line_.substr(at_, end - at_);
  if (name.empty() || IsDigit(name[0]) || name[0] == '.') return {};
  at_ = end;
  return name;
}

std::optional<std::string> Cursor::Quoted() {
  Blanks();
  const size_t end = at_ < line_.size() && line_[at_] == '"' ? line_.find('"', at_ + 1) : std::string::npos;
  if (end == std::string::npos) return std::nullopt;
  const std::string text = line_.substr(at_ + 1, end - at_ - 1);
  at_ = end + 1;
  return text;
}

std::string Cursor::Rest() {
  Blanks();
  std::string rest = line_.substr(at_);
  while (!rest.empty() && IsBlank(rest.back())) rest.pop_back();
  at_ = line_.size();
  return rest;
}

void Cursor::Need(bool happened, const char* what) const {
  if (!happened) throw Refusal{std::string(what) + " expected in: " + line_};
}

std::string Upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string Squeezed(const std::string& code) {
  std::string text;
  bool blank = false;
  for (const char c : code) {
    if (IsBlank(c)) {
      blank = true;
      continue;
    }
    if (blank && !text.empty() && IsWord(text.back()) && IsWord(c)) text += ' ';
    text += c;
    blank = false;
  }
  return text;
}

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == '\n')
      lines.emplace_back();
    else if (c != '\r')
      lines.back() += c;
  }
  return lines;
}

Step& Mover::Add(Step::Kind kind, const Joints& q) {
  Step& step = trace.steps.emplace_back();
  step.kind = kind;
  step.q = q;
  step.X_BT = ForwardFlange(machine_.arm, q) * machine_.X_FT;
  step.external = external_;
  step.line = line;
  q_ = q;
  return step;
}

Step& Mover::WayTo(const Joints& q) { return Add(Step::Kind::kWay, q); }

Step& Mover::WayTo(const Pose& X_BF, std::optional<int> status, std::optional<int> turn) {
  if (!q_ && !(status && turn)) throw Refusal{"the first pose has no status and turn"};
  const int branch = status ? *status : Status(machine_.arm, *q_);
  const auto q =
      turn ? WithSigns(machine_.arm, X_BF, branch, *turn) : InverseNear(machine_.arm, X_BF, branch, *q_);
  if (!q) throw Refusal{"the pose is out of reach"};
  return Add(Step::Kind::kWay, *q);
}

Step& Mover::CutTo(const Pose& X_BF) {
  if (!q_) throw Refusal{"a straight motion from nowhere"};
  const auto q = InverseNear(machine_.arm, X_BF, Status(machine_.arm, *q_), *q_);
  if (!q) throw Refusal{"the straight motion is out of reach"};
  Step& step = Add(Step::Kind::kCut, *q);
  step.straight = true;
  return step;
}

Step& Mover::TimedTo(const Joints& q) { return Add(Step::Kind::kCut, q); }

Step& Mover::Event(Step::Kind kind, const std::string& words) {
  const std::optional<Joints> before = q_;
  Step& step = Add(kind, before.value_or(Joints::Zero()));
  step.words = words;
  q_ = before;
  return step;
}

void Mover::Mark(const std::string& text) {
  static const std::regex mark(
      R"(^\s*[;!(]?(?:MSG\s*\(\s*"\s*)?\s*(ENDFOLD\s*\(\s*|FOLD\s+|END\s+OF\s+)?PASS\s+(-?[0-9.]+(?:E[-+]?\d+)?)\s+PIECE\s+(-?[0-9.]+(?:E[-+]?\d+)?))");
  std::smatch found;
  const std::string line_text = Upper(text);
  if (!std::regex_search(line_text, found, mark)) return;
  const double pass = std::strtod(found[2].str().c_str(), nullptr) + 0.0;  // −0 is 0
  const double piece = std::strtod(found[3].str().c_str(), nullptr) + 0.0;
  const bool end = found[1].str().starts_with("END");
  Event(Step::Kind::kSwitch, fmt::format("mark of the {} of {} {} ", end ? "end" : "begin", pass, piece));
}

void Mover::PlantCall(const std::string& name, const std::string& arguments) {
  std::string words;
  Cursor at(arguments);
  while (!at.Done()) {
    const auto number = at.Number(true);
    words += number ? fmt::format("{}", *number + 0.0) : at.Name();
    if (!number && words.empty()) throw Refusal{"arguments expected"};
    if (!at.Done() && !at.TakeChar(',') && !at.TakeChar(']') && !at.TakeChar('['))
      throw Refusal{", expected"};
    words += at.Done() ? "" : ",";
  }
  // Of a speed its number stands last: one that is hardly another is no harm.
  Event(Step::Kind::kSwitch,
        name == "SPINDLE_ON" ? "call SPINDLE_ON S" + words : fmt::format("call {}({})", name, words));
}

Pose Frame(double x, double y, double z, const Eigen::Matrix3d& R) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  pose.linear() = R;
  return pose;
}

Eigen::Matrix3d Zyx(double a, double b, double c) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(a * kRadPerDeg, Vector3d::UnitZ()) * AngleAxisd(b * kRadPerDeg, Vector3d::UnitY()) *
          AngleAxisd(c * kRadPerDeg, Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Matrix3d Oriented(const std::string& rotation, double a, double b, double c) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  if (rotation == "rpy") return Zyx(c, b, a);
  return (AngleAxisd(a * kRadPerDeg, Vector3d::UnitZ()) * AngleAxisd(b * kRadPerDeg, Vector3d::UnitX()) *
          AngleAxisd(c * kRadPerDeg, Vector3d::UnitZ()))
      .toRotationMatrix();
}

}  // namespace millpose::campaign
