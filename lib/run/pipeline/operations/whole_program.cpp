// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/operations/whole_program.hpp"

#include "program/calling_program.hpp"
#include "program/post_entry.hpp"
#include "program/program_name.hpp"
#include "run/pipeline/programs/program_files.hpp"

namespace millpose {
namespace {

std::vector<CalledProgram> CalledBy(const CallingSyntax& syntax, const std::string& controller,
                                    const std::vector<DoneOperation>& operations) {
  std::vector<CalledProgram> called;
  for (const DoneOperation& operation : operations) {
    called.push_back(AsCalled(syntax, operation.job, operation.programs.at(controller)));
    called.back().comments = {{"operation", operation.name}, {"tool", operation.tool}};
  }
  return called;
}

}  // namespace

std::vector<MainProgram> MainProgramsOf(const std::string& job,
                                        const std::vector<DoneOperation>& operations) {
  std::vector<MainProgram> mains;
  for (const DoneOperation& operation : operations) {
    if (mains.empty() || mains.back().setup != operation.setup)
      mains.push_back(
          {operation.setup.empty() ? job : OperationName(job, operation.setup), operation.setup, {}});
    mains.back().operations.push_back(operation);
  }
  return mains;
}

std::set<std::string> FilesOfMain(const MainProgram& main, const std::string& controller) {
  const CallingSyntax syntax = MakePost(controller)->Calling();
  const std::vector<CalledProgram> all = CalledBy(syntax, controller, main.operations);
  std::set<std::string> names;
  for (const auto& [name, text] : WriteCalling(syntax, main.name, {}, all)) names.insert(name);
  for (const CalledProgram& called : all)
    for (const auto& [name, text] : called.files) names.insert(name);
  return names;
}

WholeProgram MakeWholeProgram(const MainProgram& main, const std::string& controller) {
  WholeProgram whole{controller, main.name, main.setup, main.operations.size(), {}, {}, {}};
  for (const DoneOperation& operation : main.operations)
    if (!operation.programs.contains(controller)) {
      whole.withheld = fmt::format("no {} main program is written: operation {} has no {} program",
                                   controller, operation.name, controller);
      return whole;
    }
  const CallingSyntax syntax = MakePost(controller)->Calling();
  if (syntax.call.empty()) {
    whole.withheld = fmt::format(
        "no {0} main program is written: a {0} program calls no other; run those of the operations one after "
        "the other",
        controller);
    return whole;
  }
  const std::vector<CalledProgram> called = CalledBy(syntax, controller, main.operations);
  std::vector<std::pair<std::string, std::string>> header = {
      {"job", main.name},
      {"version", std::string("millpose ") + MILLPOSE_VERSION},
      {"assumed", "the programs called are of this plan; their names say of which job and operation alone"}};
  if (!main.setup.empty()) header.insert(header.begin() + 1, {"setup", main.setup});
  whole.files = WriteCalling(syntax, main.name, header, called);
  for (const CalledProgram& program : called) whole.files.insert(program.files.begin(), program.files.end());
  whole.findings = CheckWholeProgram(main, controller, whole.files);
  return whole;
}

std::vector<Finding> CheckWholeProgram(const MainProgram& program, const std::string& controller,
                                       const ProgramFiles& files, const HoldCalled& hold) {
  std::vector<Finding> findings;
  const auto add = [&](const std::string& file, int line, const std::string& message) {
    findings.push_back({file, line, message, Cause::kText});
  };
  const CallingSyntax syntax = MakePost(controller)->Calling();
  std::vector<std::string> expected;
  const std::vector<CalledProgram> called = CalledBy(syntax, controller, program.operations);
  const std::string main = ProgramName(syntax, program.name) + syntax.ending;
  std::set<std::string> read = {main};
  for (size_t i = 0; i < called.size(); ++i) {
    expected.push_back(called[i].name);
    ProgramFiles given;
    bool missing = false, same = true;
    for (const auto& [name, text] : called[i].files) {
      read.insert(name);
      const auto found = files.find(name);
      missing |= found == files.end();
      if (found == files.end()) {
        add(name, 0, "is missing");
        continue;
      }
      given.insert(*found);
      same &= found->second == text;
      if (found->second != text && !hold)
        add(name, 1, "is not the program that the operation's own folder holds");
    }
    if (!same && !missing && hold)
      std::ranges::copy(hold(program.operations[i], given), std::back_inserter(findings));
  }
  ProgramFiles written = WriteCalling(syntax, program.name, {}, called);
  CompareBeside(files, written, read, true, findings);
  try {
    const std::vector<std::string> calls = ReadCalling(syntax, program.name, files);
    if (calls != expected)
      add(main, 1, fmt::format("calls {}; expected: {}", fmt::join(calls, ", "), fmt::join(expected, ", ")));
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems())
      add(problem.place.file, problem.place.line, problem.message);
  }
  return findings;
}

}  // namespace millpose
