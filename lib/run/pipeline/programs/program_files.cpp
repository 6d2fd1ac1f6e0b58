// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/program_files.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "program/post_entry.hpp"
#include "program/reader.hpp"

namespace millpose {

namespace fs = std::filesystem;

namespace {

struct CodeLine {
  std::string text;
  int number;
};

/// The lines that are more than a comment, as they count.
std::vector<CodeLine> CodeOf(const std::string& text) {
  std::vector<CodeLine> code;
  int number = 0;
  for (const std::string_view line : SplitLines(text)) {
    ++number;
    std::string spelled = Spelled(line.substr(0, line.find(';')));
    if (!spelled.empty()) code.push_back({std::move(spelled), number});
  }
  return code;
}

}  // namespace

std::vector<std::string> MainEndings() {
  std::vector<std::string> endings;
  for (const PostEntry& entry : Posts().entries()) {
    const std::string ending = entry.make()->Endings().front();
    if (std::ranges::find(endings, ending) == endings.end()) endings.push_back(ending);
  }
  return endings;
}

std::vector<std::string> SortedFiles(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string ControllerOf(const fs::path& program, const CellSettings& cell) {
  std::string found;
  for (const PostEntry& entry : Posts().entries()) {
    const std::vector<std::string> endings = entry.make()->Endings();
    if (std::ranges::find(endings, program.extension().string()) == endings.end()) continue;
    if (cell.controllers.contains(entry.name)) return entry.name;
    if (found.empty()) found = entry.name;
  }
  if (!found.empty()) return found;
  std::vector<std::string> endings = MainEndings();
  const std::string last = endings.back();
  endings.pop_back();
  throw InputError(SourceLocation{program.string(), 0, 0, -1},
                   fmt::format("a folder of millpose plan, or a program ending in {} or {} expected",
                               fmt::join(endings, ", "), last));
}

ProgramFiles FilesOf(const fs::path& program, const Post& post, const FileRoot& root) {
  const std::vector<std::string> endings = post.Endings();
  ProgramFiles files = {{program.filename().string(), root.Read(program)}};
  const std::vector<std::string> beside =
      SortedFiles(program.has_parent_path() ? program.parent_path() : ".");
  for (bool found = true; found;) {
    found = false;
    for (const std::string& name : beside) {
      const std::string extension = fs::path(name).extension().string();
      const bool may = std::ranges::find(endings, extension) != endings.end();
      if (!may || files.contains(name)) continue;
      const bool called = std::any_of(files.begin(), files.end(), [&](const auto& file) {
        return CallsProgram(file.second, fs::path(name).stem().string());
      });
      if (!called) continue;
      files[name] = root.Read(program.parent_path() / name);
      found = true;
    }
  }
  for (const auto& [ending, unused] : post.Calling().beside) {
    ProgramFiles more;
    for (const auto& [name, text] : files)
      if (const std::string other = fs::path(name).stem().string() + ending;
          std::ranges::binary_search(beside, other))
        more[other] = root.Read(program.parent_path() / other);
    files.merge(more);
  }
  return files;
}

void CompareBeside(const ProgramFiles& files, const ProgramFiles& written, const std::set<std::string>& read,
                   bool complete, std::vector<Finding>& findings) {
  const auto add = [&](const std::string& file, int line, std::string message) {
    findings.push_back({file, line, std::move(message), Cause::kText});
  };
  for (const auto& [name, text] : written) {
    if (read.contains(name)) continue;
    const auto given = files.find(name);
    if (given == files.end()) {
      if (complete) add(name, 0, "is missing");
      continue;
    }
    const std::vector<CodeLine> is = CodeOf(given->second), was = CodeOf(text);
    for (size_t i = 0; i < std::max(is.size(), was.size()); ++i) {
      const std::string here = i < is.size() ? is[i].text : "nothing more";
      const std::string before = i < was.size() ? was[i].text : "nothing more";
      if (here == before) continue;
      add(name, i < is.size() ? is[i].number : 0,
          fmt::format("'{}' is here, written was '{}'", here, before));
      break;
    }
  }
  for (const auto& [name, text] : files)
    if (!read.contains(name) && !written.contains(name)) add(name, 0, "is not of this program");
}

}  // namespace millpose
