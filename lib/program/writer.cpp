// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/writer.hpp"

#include "program/controller_axes.hpp"
#include "program/scanner.hpp"

namespace millpose {

ProgramWriter::ProgramWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
                             std::map<std::string, std::string> texts)
    : program_(program),
      arm_(arm),
      settings_(settings),
      X_FT_(program.X_FT.value_or(settings.X_FT)),
      templates_(std::move(texts), settings.texts, ToolOf(settings)) {}

void ProgramWriter::WriteSections() {
  const auto begin = [&] {
    sections_.emplace_back();
    Begin();
  };
  begin();
  size_t event = 0;
  for (size_t i = 0; i <= program_.motions.size(); ++i) {
    for (; event < program_.events.size() && program_.events[event].before_motion == i; ++event) {
      const ProgramEvent::Kind kind = program_.events[event].kind;
      Event(program_.events[event]);
      if (kind == ProgramEvent::Kind::kPassEnd || kind == ProgramEvent::Kind::kHandover) begin();
    }
    if (i == program_.motions.size()) return;
    const int call = program_.motions[i].call;
    if (call >= 0) {
      const std::string& text = program_.calls[static_cast<size_t>(call)].text;
      AddLines(templates_.Lines(text), text);
      continue;
    }
    ++sections_.back().motions;
    AddMotion(i);
  }
}

std::vector<std::string> ProgramWriter::Parts() const {
  int all_motions = 0;
  size_t all_bytes = 0;
  for (const Section& section : sections_) {
    all_motions += section.motions;
    all_bytes += section.text.size();
  }
  if (all_motions <= settings_.max_motions && all_bytes <= settings_.max_bytes()) return {};
  std::vector<std::string> texts;
  int motions = 0;
  for (size_t i = 0; i + 1 < sections_.size(); ++i) {
    const Section& section = sections_[i];
    const bool fits = !texts.empty() && motions + section.motions <= settings_.max_motions &&
                      texts.back().size() + section.text.size() <= settings_.max_bytes();
    if (!fits) {
      texts.emplace_back();
      motions = 0;
    }
    texts.back() += section.text;
    motions += section.motions;
  }
  return texts;
}

std::string ProgramWriter::MainText(const std::vector<std::string>& parts) const {
  std::string text;
  for (size_t i = parts.empty() ? 0 : sections_.size() - 1; i < sections_.size(); ++i)
    text += sections_[i].text;
  return text;
}

std::vector<std::string> ProgramWriter::HeaderTexts(size_t width) const {
  std::vector<std::string> texts;
  for (const auto& [key, value] : program_.header)
    std::ranges::copy(HeaderLines(key, value, width), std::back_inserter(texts));
  return texts;
}

std::string ProgramWriter::TextLines(const std::string& name) const {
  if (templates_.Calls(name, settings_.calls, true) || (name == "tool_change" && settings_.change_at))
    return {};
  std::string text;
  for (const std::string& line : templates_.Lines(name)) text += line + "\n";
  if (name != "footer" && templates_.Calls(name, settings_.calls, false)) text += Settings();
  return text;
}

void ProgramWriter::AddText(const std::string& name) { AddLines(templates_.Lines(name), name); }

void ProgramWriter::AddTexts(const ProgramEvent& event) {
  const std::string name = Templates::NameOf(event.kind);
  if (!name.empty()) AddLines(templates_.Lines(event), name);
}

void ProgramWriter::AddLines(const std::vector<std::string>& lines, const std::string& name) {
  for (const std::string& line : lines) Line(line);
  if (!templates_.Calls(name, settings_.calls, false) && name != "tool_change") return;
  sections_.back().text += Settings();
  Forget();
}

int ProgramWriter::TurnAt(const Motion& motion, const Pose& X_PC_as_written) const {
  const std::optional<Pose>& X_BP = FrameOf(program_, motion);
  if (!motion.q || !X_BP) return *motion.turn;
  Pose X_PT = X_PC_as_written;
  X_PT.linear() = X_PT.linear() * settings_.R_TC().transpose();
  const Pose X_BF = *X_BP * X_PT * X_FT_.inverse();
  return TurnAsWritten(arm_, settings_.axes, X_BF, *motion.status, *motion.q);
}

std::string PlainAscii(std::string text) {
  for (char& c : text) c = c < ' ' || c > '~' ? '?' : c;
  return text;
}

std::vector<std::string> HeaderLines(const std::string& key, const std::string& value, size_t width) {
  const std::string plain = PlainAscii(value), begin = PlainAscii(key) + ": ";
  const size_t room = width - std::min(begin.size(), width / 2);
  std::vector<std::string> lines;
  std::string_view rest = Trim(plain);
  do {
    size_t length = rest.size();
    if (length > room) {
      const size_t blank = rest.rfind(' ', room);
      length = blank == std::string_view::npos || blank == 0 ? room : blank;
    }
    lines.emplace_back(Trim(begin + std::string(Trim(rest.substr(0, length)))));
    rest = Trim(rest.substr(length));
  } while (!rest.empty());
  return lines;
}

}  // namespace millpose
