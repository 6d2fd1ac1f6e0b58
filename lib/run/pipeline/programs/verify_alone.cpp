// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/verify_alone.hpp"

#include <set>

#include "base/error.hpp"
#include "job/assemble.hpp"
#include "job/cell_texts.hpp"
#include "program/calling_program.hpp"
#include "program/pose_text.hpp"
#include "program/scanner.hpp"
#include "program/verify/standing_alone.hpp"
#include "run/pipeline/programs/program_files.hpp"
#include "run/pipeline/programs/programming.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

/// Frames that the program leaves to the controller, as far as its own header and the cell tell them. Returns
/// what is assumed thereby.
std::vector<std::string> AssumeFrames(MotionProgram& program, const Pose& X_KB) {
  std::vector<std::string> assumptions = {"the part is not there: clearance from it is not checked"};
  const auto is_pose = [](const Motion& motion) { return !motion.q; };
  if (std::ranges::none_of(program.motions, is_pose)) return assumptions;
  if (!program.X_FT) assumptions.push_back("the controller's tool is the cell's");
  if (program.X_BP) return assumptions;
  for (const auto& [key, value] : program.header) {
    if (key != "base_pose") continue;
    const std::optional<Pose> X_KP = ReadPoseText(value);
    if (X_KP) program.X_BP = X_KB.inverse() * *X_KP;
    assumptions.push_back("the controller's base is as the header's base_pose says: " + value);
  }
  if (!program.X_BP)
    throw InputError(SourceLocation{program.files.front(), 1, 0, -1},
                     "the base is a frame that the controller holds; a line 'base_pose: " +
                         PoseText(Pose::Identity()) + "' with its values expected in the header");
  return assumptions;
}

/// One program in a cell that has one tool.
VerifiedProgram VerifyOne(const fs::path& file, const JobInputs& inputs, const std::string& controller,
                          const VerifyArguments& arguments, const Execution& execution) {
  const World world(MakeCell(inputs.cell, inputs.body_bytes));
  const Programming with(inputs, controller, world, execution);
  const Post& post = with.post;
  ProgramFiles files = FilesOf(file, post, arguments.root);
  std::string& main = files.at(file.filename().string());
  main = AsStandingAlone(post.Calling(), file.stem().string(), main);
  MotionProgram program = post.Read(files, world.cell().arm, with.settings);
  VerifiedProgram verified{controller, file.string(), program.motions.size(), {}, {}, {}, ScopeOf(program)};
  verified.assumptions = AssumeFrames(program, post.BaseInWorld(with.settings));
  for (const DeclaredCall& call : program.calls) verified.assumptions.push_back(AssumptionOf(call));
  std::ranges::copy(post.Assumptions(with.settings), std::back_inserter(verified.assumptions));
  std::ranges::copy(CellWarnings(inputs.cell), std::back_inserter(verified.assumptions));
  verified.findings = CheckStandingAlone(program, world.cell(), post.HasOwnWorld(), with.options);
  std::ranges::copy(Verify(program, world, nullptr, with.options, with.execution),
                    std::back_inserter(verified.findings));
  verified.but_for = FindCornerBound(program, world.cell());
  return verified;
}

/// What a program says in comments, line by line, whatever begins one.
std::vector<std::string_view> CommentsOf(const std::string& text) {
  std::vector<std::string_view> comments;
  for (const std::string_view line : SplitLines(text))
    if (const size_t sign = line.find_first_of(";!#"); sign != std::string_view::npos)
      comments.push_back(Trim(line.substr(sign + 1)));
  return comments;
}

/// The cell's tool that a program says in its header that it is for; empty where it names none or several.
std::string ToolIn(const std::string& text, const CellSettings& cell) {
  std::set<std::string> named;
  for (const std::string_view comment : CommentsOf(text)) {
    LineScanner scan(comment, "", 0);
    if (!scan.Accept("tool:")) continue;
    while (!scan.AtEnd()) {
      const auto word = scan.AcceptName();
      if (!word) scan.Skip();
      for (const ToolSettings& tool : cell.tools)
        if (word == tool.name) named.insert(tool.name);
    }
  }
  return named.size() == 1 ? *named.begin() : std::string();
}

/// Whether a program says in its header that its tool is in the spindle already.
bool SaysHeld(const std::string& text) {
  return std::ranges::any_of(CommentsOf(text), [](std::string_view comment) {
    return comment.starts_with(std::string(kToolHeldKey) + ':');
  });
}

/// The file that a main program calls by `name`, beside it.
fs::path CalledFile(const fs::path& main, const CallingSyntax& syntax, const std::string& name) {
  fs::path file = main.parent_path() / (name + syntax.called_ending);
  if (!fs::exists(file))
    throw InputError(SourceLocation{main.string(), 0, 0, -1},
                     fmt::format("calls {}; {} is not beside it", name, file.filename().string()));
  return file;
}

}  // namespace

std::vector<VerifiedProgram> VerifyAlone(const VerifyArguments& arguments, const Execution& execution) {
  if (!arguments.cell) {
    throw InputError(SourceLocation{arguments.target.string(), 0, 0, -1},
                     "a program needs its cell, or the plan that it was written from: --cell CELL.yaml or "
                     "--plan DIR expected");
  }
  JobInputs inputs;
  inputs.cell = LoadCell(*arguments.cell, &inputs.body_bytes, arguments.root);
  const std::string controller = ControllerOf(arguments.target, inputs.cell);
  const CallingSyntax syntax = MakePost(controller)->Calling();
  const std::vector<std::string> calls =
      CallsOf(syntax, arguments.target.stem().string(), arguments.root.Read(arguments.target));
  std::vector<fs::path> files = {arguments.target};
  if (!calls.empty()) files.clear();
  for (const std::string& name : calls) files.push_back(CalledFile(arguments.target, syntax, name));
  std::vector<VerifiedProgram> programs;
  for (const fs::path& file : files) {
    JobInputs own = inputs;
    const bool tells = arguments.tool.empty() && !calls.empty();
    SelectTool(tells ? ToolIn(arguments.root.Read(file), own.cell) : arguments.tool, &own.cell);
    own.job.tool_held = SaysHeld(arguments.root.Read(file));
    programs.push_back(VerifyOne(file, own, controller, arguments, execution));
  }
  return programs;
}

}  // namespace millpose
