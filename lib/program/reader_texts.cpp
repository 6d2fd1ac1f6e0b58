// SPDX-License-Identifier: GPL-3.0-or-later
// The texts of a cell and the calls that it declares, as readers of all controllers meet them.
#include "base/text.hpp"
#include "program/reader.hpp"

namespace millpose {

size_t ProgramReader::ReadTexts(size_t i) {
  if (awaited_) {
    if (const size_t taken = ReadText(*awaited_, i)) return taken;
  }
  if (const auto match = templates_.Recognise(lines_, i)) {
    const bool on = match->kind == ProgramEvent::Kind::kSpindleOn;
    AllowText(on ? "spindle_on" : "spindle_off");
    AddEvent(match->kind, match->value, 0);
    ReadTextLines(i, match->lines);
    return match->lines;
  }
  for (const std::string name : {"header", "tool_change", "footer", "cartesian_on", "joints_on"}) {
    if (const size_t taken = ReadText(name, i)) return taken;
  }
  return 0;
}

/// The text `name`, where its place is here: how many lines it takes.
size_t ProgramReader::ReadText(const std::string& name, size_t i) {
  const bool repeats = name == "cartesian_on" || name == "joints_on" || name == awaited_;
  if (!repeats && seen_[name]) return 0;
  const bool awaited = name == awaited_;
  const size_t taken = awaited ? templates_.Recognise(name, lines_, i, program_.events.back().value,
                                                      program_.events.back().piece)
                               : templates_.Recognise(name, lines_, i);
  if (taken == 0) return 0;
  if (awaited) awaited_.reset();
  seen_[name] = true;
  AllowText(name);
  AddHandEvent(ProgramEvent::Kind::kText, name);
  ReadTextLines(i, name == "tool_change" ? templates_.BeforeCheck(lines_, i, taken) : taken);
  if (name == "tool_change" && IsChangeByHand()) AddChangeByHand();
  TextRead(name);
  return taken;
}

bool ProgramReader::IsChangeByHand() const {
  return settings_.change_at && !templates_.Calls("tool_change", settings_.calls, true);
}

/// The arm stands where the cell has the tool changed, and stays there.
void ProgramReader::AddChangeByHand() {
  program_.calls.push_back(ChangeByHand(*settings_.change_at));
  Motion& motion = program_.motions.emplace_back();
  motion.q = *settings_.change_at;
  motion.external = external_;
  motion.exact = true;
  motion.call = static_cast<int>(program_.calls.size()) - 1;
  motion.file = file_;
  motion.line = line_;
}

/// A text that switches things stands where the cell has it, never in a cut.
void ProgramReader::AllowText(const std::string& name) {
  Places places = kOutsideCuts;
  const bool moves =
      templates_.Calls(name, settings_.calls, true) || (name == "tool_change" && settings_.change_at);
  if (name == "header" || name == "tool_change")
    places = moves ? Places{ProgramPlace::kHead, ProgramPlace::kWay} : kHeadOnly;
  if (name == "footer") places = moves ? Places{ProgramPlace::kTail, ProgramPlace::kWay} : kTailOnly;
  rules_.Add({open_.back(), line_, 0, -1}, fmt::format("the cell's text {}", name), program_.motions.size(),
             places);
}

/// What the lines of a text do, as anywhere else; what they say as comments is nobody's mark.
void ProgramReader::ReadTextLines(size_t i, size_t count) {
  in_text_ = true;
  const int first = line_;
  for (size_t k = i; k < i + count; ++k) {
    line_ = static_cast<int>(k) + 1;
    try {
      if (!Trim(lines_[k]).empty() && !Comment(Trim(lines_[k]))) {
        LineScanner scan(WithoutComment(lines_[k]), open_.back(), line_);
        ReadCode(scan);
      }
    } catch (const InputError& error) {
      problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
    }
  }
  line_ = first;
  in_text_ = false;
}

void ProgramReader::ExpectTexts(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (templates_.Lines(name).empty() || seen_[name]) continue;
    problems_.push_back({{program_.files[0], 1, 0, -1}, fmt::format("the cell's text {} is missing", name)});
  }
}

std::vector<Problem> ProgramReader::CheckTexts() {
  checking_ = true;
  program_.files = {""};
  for (const auto& [name, text] : settings_.texts) {
    const std::string filled = Templates::WithSamples(text, ToolOf(settings_));
    open_ = {name};
    lines_ = SplitLines(filled);
    labels_.clear();
    BeginFile();
    ReadTextLines(0, lines_.size());
  }
  return std::move(problems_);
}

bool ProgramReader::IsDeclared(const std::string& name) const {
  return std::any_of(settings_.calls.begin(), settings_.calls.end(),
                     [&](const DeclaredCall& call) { return SameWords(call.name, name); });
}

/// Which text makes it tells what it is for.
void ProgramReader::AddCall(const DeclaredCall& call, const std::string& arguments) {
  if (in_text_) return;
  AddEvent(ProgramEvent::Kind::kCall, 0, 0);
  program_.events.back().text = fmt::format("{}({})", Spelled(call.name), arguments);
  for (const std::string& text : Templates::Names())
    if (templates_.Calls(text, {call}, false)) program_.events.back().of = text;
}

std::string ProgramReader::ReadArguments(LineScanner& scan) {
  std::string arguments;
  if (scan.Accept(")")) return arguments;
  do {
    const size_t start = scan.Next();
    if (scan.Accept("\"")) {
      while (scan.Peek() != '"' && scan.Peek() != '\0') scan.Skip();
      scan.Expect("\"");
      arguments += scan.TakenFrom(start);
    } else if ((!scan.Accept("#") && scan.AcceptName()) || scan.AcceptName()) {
      arguments += Spelled(scan.TakenFrom(start));
    } else {
      arguments += ShortestNumber(scan.ExpectNumber());
    }
    arguments += ",";
  } while (scan.Accept(","));
  scan.Expect(")");
  arguments.pop_back();
  return arguments;
}

bool ProgramReader::ReadDeclaredCall(const LineScanner& scan, size_t start, const std::string& name,
                                     const std::string& arguments) {
  const auto declared = std::find_if(settings_.calls.begin(), settings_.calls.end(),
                                     [&](const DeclaredCall& call) { return SameWords(call.name, name); });
  if (declared == settings_.calls.end()) return false;
  Places places = kOutsideCuts;
  if (declared->moves) places = {ProgramPlace::kHead, ProgramPlace::kWay, ProgramPlace::kTail};
  Allow(scan, start, places);
  const auto known = std::find_if(program_.calls.begin(), program_.calls.end(),
                                  [&](const DeclaredCall& call) { return call.name == declared->name; });
  const int index = static_cast<int>(known - program_.calls.begin());
  AddCall(*declared, arguments);
  if (known == program_.calls.end()) program_.calls.push_back(*declared);
  if (declared->moves) {
    Motion& motion = program_.motions.emplace_back();
    motion.q = declared->to;
    motion.external = external_;
    motion.exact = true;
    motion.call = index;
    motion.file = file_;
    motion.line = line_;
  }
  Forget(fmt::format("the call of {}", declared->name));
  return true;
}

}  // namespace millpose
