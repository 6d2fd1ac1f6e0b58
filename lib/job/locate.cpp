// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/locate.hpp"

#include "base/text.hpp"
#include "base/yaml/value.hpp"
#include "job/config/operations.hpp"

namespace millpose {
namespace {

/// The steps of a key's path: "toolpath", "drill", "holes", "2".
std::vector<std::string> StepsOf(std::string_view path) {
  std::vector<std::string> steps(1);
  for (const char c : path) {
    if (c == ']') continue;
    if (c == '.' || c == '[')
      steps.emplace_back();
    else
      steps.back() += c;
  }
  return steps;
}

/// What a message says about, where it begins with the path of a key.
std::string_view PathOf(std::string_view message) {
  const size_t colon = message.find(':');
  const std::string_view path = message.substr(0, colon == std::string_view::npos ? 0 : colon);
  const bool is_path =
      path.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_.[]ABCDEFGHIJKLMNOPQRSTUVWXYZ") ==
      std::string_view::npos;
  return is_path ? path : std::string_view();
}

/// Where the value of a path stands, or that of the nearest section above it; unknown where the file has none
/// of them.
yaml::Mark MarkOf(const yaml::Value& root, std::string_view path) {
  const yaml::Value* at = &root;
  yaml::Mark mark;
  for (const std::string& step : StepsOf(path)) {
    const yaml::Value* next = nullptr;
    if (at->kind == yaml::Value::Kind::kMap) {
      next = at->Find(step);
      if (next) mark = at->FindKey(step)->mark;
    } else if (at->kind == yaml::Value::Kind::kList) {
      const auto index = ParseNumber(step);
      if (index && *index >= 0 && *index < static_cast<double>(at->items.size()))
        next = &at->items[static_cast<size_t>(*index)], mark = next->mark;
    }
    if (!next) break;
    at = next;
    if (at->kind == yaml::Value::Kind::kScalar) mark = at->mark;
  }
  return mark;
}

}  // namespace

InputError Located(const InputError& error, const JobInputs& inputs) {
  const std::string& job_file = inputs.job.file;
  InputError in_cell = LocatedInCell(error, inputs.cell);
  yaml::Value root;
  try {
    root = yaml::ReadYaml(inputs.job_text, job_file);
    if (inputs.operation && root.Find("operations")) root = config::OperationRoot(root, *inputs.operation);
  } catch (const InputError&) {
    return in_cell;
  }
  std::vector<Problem> problems = in_cell.problems();
  for (Problem& problem : problems) {
    if (problem.place.line != 0 || (!problem.place.file.empty() && problem.place.file != job_file)) continue;
    const std::string_view path = PathOf(problem.message);
    if (path.empty()) continue;
    const yaml::Mark mark = MarkOf(root, path);
    // A word that is no key of this job ("dry run: …") stays as it is.
    if (mark.line == 0 && problem.place.file.empty()) continue;
    problem.place = {job_file, mark.line, mark.column};
  }
  return InputError(std::move(problems));
}

InputError LocatedInCell(const InputError& error, const CellSettings& cell) {
  std::vector<Problem> problems = error.problems();
  const auto is_open = [&](const Problem& problem) {
    return problem.place.line == 0 && !cell.file.empty() && problem.place.file == cell.file &&
           !PathOf(problem.message).empty();
  };
  if (cell.text.empty() || std::ranges::none_of(problems, is_open)) return error;
  const yaml::Value root = yaml::ReadYaml(cell.text, cell.file);
  for (Problem& problem : problems) {
    if (!is_open(problem)) continue;
    const yaml::Mark mark = MarkOf(root, PathOf(problem.message));
    problem.place = {cell.file, mark.line, mark.column};
  }
  return InputError(std::move(problems));
}

}  // namespace millpose
