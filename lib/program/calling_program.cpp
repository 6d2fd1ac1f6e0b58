// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/calling_program.hpp"

#include <cassert>

#include "program/post_keys.hpp"
#include "program/program_name.hpp"
#include "program/scanner.hpp"
#include "program/writer.hpp"

namespace millpose {
namespace {

std::string Filled(std::string text, const std::string& name) {
  constexpr std::string_view kHole = "{name}";
  for (size_t at = text.find(kHole); at != std::string::npos; at = text.find(kHole, at + name.size()))
    text.replace(at, kHole.size(), name);
  return text;
}

std::string CalledName(const CallingSyntax& syntax, const std::string& job) {
  std::string name = ProgramName(syntax, job);
  if (syntax.called_lower)
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return name;
}

std::string Comments(const CallingSyntax& syntax, const std::string& key, const std::string& value) {
  std::string text;
  for (const std::string& line : HeaderLines(key, value, syntax.comment_width))
    text += syntax.comment_begin + line + syntax.comment_end + "\n";
  return text;
}

/// Whether the line holds a statement.
bool HoldsCode(const CallingSyntax& syntax, std::string_view line) {
  return !Trim(line).empty() && !Trim(line).starts_with(Trim(syntax.comment_begin));
}

/// What a line calls; empty where it calls nothing.
std::string CallIn(const CallingSyntax& syntax, std::string_view line) {
  const std::string_view call = SplitLines(syntax.call).front();
  const size_t hole = call.find("{name}");
  const std::string_view before = call.substr(0, hole), behind = call.substr(hole + 6);
  if (line.size() <= before.size() + behind.size() || !line.starts_with(before) || !line.ends_with(behind))
    return {};
  const std::string name(line.substr(before.size(), line.size() - before.size() - behind.size()));
  return IsWord(name) ? name : std::string();
}

}  // namespace

std::string ProgramName(const CallingSyntax& syntax, const std::string& job) {
  std::string name = LegalName(job, syntax.longest, syntax.letters);
  return syntax.reserved.contains(AsTold(name)) ? "mp_" + name : name;
}

CalledProgram AsCalled(const CallingSyntax& syntax, const std::string& job, ProgramFiles files) {
  CalledProgram called{CalledName(syntax, job), {}, {}};
  auto main = files.extract(ProgramName(syntax, job) + syntax.ending);
  const std::string tail = Filled(syntax.tail, ProgramName(syntax, job));
  assert(!main.empty() && main.mapped().ends_with(tail));
  std::string text = main.mapped().substr(0, main.mapped().size() - tail.size());
  text = Filled(syntax.called_head, called.name) + text + Filled(syntax.called_tail, called.name);
  called.files = std::move(files);
  called.files[called.name + syntax.called_ending] = std::move(text);
  return called;
}

ProgramFiles WriteCalling(const CallingSyntax& syntax, const std::string& job,
                          const std::vector<std::pair<std::string, std::string>>& header,
                          const std::vector<CalledProgram>& programs) {
  const std::string name = ProgramName(syntax, job);
  std::string text = Filled(syntax.head, name);
  for (const auto& [key, value] : header) text += Comments(syntax, key, value);
  for (const CalledProgram& program : programs) {
    for (const auto& [key, value] : program.comments) text += Comments(syntax, key, value);
    text += Filled(syntax.call, program.name);
  }
  ProgramFiles files = {{name + syntax.ending, text + Filled(syntax.closing + syntax.tail, name)}};
  for (const auto& [ending, more] : syntax.beside) files[name + ending] = Filled(more, name);
  return files;
}

namespace {

/// The calls in the main program `name`.
std::vector<std::string> ReadCalls(const CallingSyntax& syntax, const std::string& name,
                                   const std::string& text) {
  const std::string file = name + syntax.ending;
  const std::string head = Filled(syntax.head, name), tail = Filled(syntax.closing + syntax.tail, name);
  std::vector<std::string_view> before = SplitLines(head), behind = SplitLines(tail);
  const auto empty = [&](std::string_view line) { return !HoldsCode(syntax, line); };
  std::erase_if(before, empty);
  std::erase_if(behind, empty);
  std::vector<std::string> calls;
  std::vector<Problem> problems;
  size_t next_before = 0, next_behind = 0;
  int number = 0;
  for (const std::string_view line : SplitLines(text)) {
    ++number;
    const auto add = [&](std::string message) {
      problems.push_back({{file, number, 0, -1}, std::move(message)});
    };
    if (empty(line)) continue;
    if (next_before < before.size()) {
      if (Trim(line) != Trim(before[next_before]))
        add(fmt::format("'{}' expected", Trim(before[next_before])));
      ++next_before;
    } else if (next_behind == 0 && !CallIn(syntax, Trim(line)).empty() && Trim(line) != Trim(behind[0])) {
      calls.push_back(CallIn(syntax, Trim(line)));
    } else if (next_behind < behind.size() && Trim(line) == Trim(behind[next_behind])) {
      ++next_behind;
    } else {
      add("the call of a program or the end expected");
    }
  }
  if (next_behind < behind.size())
    problems.push_back({{file, number, 0, -1}, "the end of the program is missing"});
  if (!problems.empty()) throw InputError(std::move(problems));
  return calls;
}

}  // namespace

std::vector<std::string> ReadCalling(const CallingSyntax& syntax, const std::string& job,
                                     const ProgramFiles& files) {
  const std::string name = ProgramName(syntax, job), file = name + syntax.ending;
  const auto found = files.find(file);
  if (found == files.end()) throw InputError({file}, "is missing");
  return ReadCalls(syntax, name, found->second);
}

std::vector<std::string> CallsOf(const CallingSyntax& syntax, const std::string& stem,
                                 const std::string& text) {
  if (syntax.call.empty()) return {};
  try {
    return ReadCalls(syntax, stem, text);
  } catch (const InputError&) {
    return {};
  }
}

std::string AsStandingAlone(const CallingSyntax& syntax, const std::string& name, const std::string& text) {
  if (syntax.call.empty()) return text;
  const std::string head = Filled(syntax.called_head, name), tail = Filled(syntax.called_tail, name);
  std::vector<std::string> lines;
  for (const std::string_view line : SplitLines(text)) lines.emplace_back(line);
  const auto holds_code = [&](const std::string& line) { return HoldsCode(syntax, line); };
  const auto first = std::ranges::find_if(lines, holds_code);
  const auto last = std::find_if(lines.rbegin(), lines.rend(), holds_code);
  if (last == lines.rend() || !SameWords(*last, tail.substr(0, tail.find('\n'))) ||
      (!head.empty() && !SameWords(*first, head.substr(0, head.find('\n')))))
    return text;
  *last = syntax.tail.substr(0, syntax.tail.find('\n'));
  if (!head.empty()) first->clear();
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

}  // namespace millpose
