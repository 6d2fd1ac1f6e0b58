// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/fanuc/fanuc_file.hpp"

#include <set>

#include "program/fanuc/fanuc_positions.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

enum class Part : uint8_t { kBefore, kAttributes, kApplication, kStatements, kPositions, kEnd };

/// Attributes that move nothing; of DEFAULT_GROUP the value counts.
const std::vector<std::string> kAttributes = {
    "OWNER",         "COMMENT",       "PROG_SIZE",     "CREATE",       "MODIFIED",
    "FILE_NAME",     "VERSION",       "LINE_COUNT",    "MEMORY_SIZE",  "PROTECT",
    "TCD",           "STACK_SIZE",    "TASK_PRIORITY", "TIME_SLICE",   "BUSY_LAMP_OFF",
    "ABORT_REQUEST", "PAUSE_REQUEST", "DEFAULT_GROUP", "CONTROL_CODE", "LOCAL_REGISTERS"};

class FileReader {
 public:
  FileReader(const std::string& file, const std::string& stem, const std::string& text,
             const PostSettings& settings, const FanucOptions& options, std::vector<Problem>& problems)
      : file_(file),
        stem_(stem),
        lines_(SplitLines(text)),
        settings_(settings),
        options_(options),
        problems_(problems) {}

  FanucFile Read() {
    for (line_ = 0; line_ < lines_.size(); ++line_) {
      statement_.clear();
      try {
        ReadLine();
      } catch (const InputError& error) {
        problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
      }
      result_.statements += statement_ + "\n";
    }
    for (const auto& [part, name] :
         {std::pair(Part::kAttributes, "/ATTR"), std::pair(Part::kStatements, "/MN"),
          std::pair(Part::kPositions, "/POS")})
      if (!seen_.contains(part)) Add(fmt::format("the section {} is missing", name), 1);
    if (seen_.contains(Part::kAttributes) && !grouped_)
      Add(fmt::format("DEFAULT_GROUP = {} is missing", FanucGroups(settings_)), 1);
    return std::move(result_);
  }

 private:
  void Add(const std::string& message, int line) { problems_.push_back({{file_, line, 0, -1}, message}); }

  void ReadLine() {
    const std::string_view line = Trim(lines_[line_]);
    if (line.empty()) return;
    LineScanner scan(lines_[line_], file_, static_cast<int>(line_) + 1);
    if (line.starts_with('/')) return ReadSection(scan);
    if (part_ == Part::kStatements) return ReadStatement(scan);
    if (part_ == Part::kAttributes) return ReadAttribute(scan);
    if (part_ == Part::kApplication)
      scan.Fail("an empty section /APPL expected: what it switches on may move the arm otherwise");
    if (part_ != Part::kPositions)
      scan.Fail(part_ == Part::kEnd ? "nothing expected behind /END" : "/PROG expected");
  }

  /// Each once, in their order.
  void ReadSection(LineScanner& scan) {
    static const std::vector<std::pair<const char*, Part>> sections = {{"/ATTR", Part::kAttributes},
                                                                       {"/APPL", Part::kApplication},
                                                                       {"/MN", Part::kStatements},
                                                                       {"/POS", Part::kPositions},
                                                                       {"/END", Part::kEnd}};
    if (part_ == Part::kBefore && !named_) {
      scan.Expect("/PROG");
      const auto name = scan.AcceptName();
      if (!name || !SameWords(*name, stem_)) scan.Fail(fmt::format("the file's name {} expected", stem_));
      scan.ExpectEnd();
      named_ = true;
      return;
    }
    for (const auto& [word, part] : sections) {
      if (!scan.Accept(word)) continue;
      if (part <= part_)
        scan.Fail("each section once, in the order /PROG, /ATTR, /APPL, /MN, /POS, /END expected");
      scan.ExpectEnd();
      part_ = part;
      seen_.insert(part);
      if (part == Part::kPositions) ReadPositions();
      if (part == Part::kEnd) statement_ = "/END";
      return;
    }
    scan.Fail("a section /ATTR, /APPL, /MN, /POS or /END expected");
  }

  void ReadPositions() {
    size_t last = line_ + 1;
    while (last < lines_.size() && !Trim(lines_[last]).starts_with('/')) ++last;
    result_.positions = ReadFanucPositions(file_, lines_, line_ + 1, last, settings_, options_, problems_);
  }

  void ReadAttribute(LineScanner& scan) {
    const size_t start = scan.Next();
    const std::string name = scan.AcceptName().value_or("");
    if (std::ranges::find(kAttributes, name) == kAttributes.end()) {
      const std::string near = NearestName(name, kAttributes);
      scan.FailFrom(
          start, fmt::format("an attribute expected{}", near.empty() ? "" : "; did you mean " + near + "?"));
    }
    if (name != "DEFAULT_GROUP") return;
    scan.Expect("=");
    const size_t value = scan.Next();
    const std::string groups = Spelled(scan.TakeUntil(';'));
    grouped_ = true;
    // Further groups may be named; none of them may be used.
    if (!groups.starts_with(FanucGroups(settings_)) ||
        groups.find_first_not_of(",*", FanucGroups(settings_).size()) != std::string::npos)
      scan.FailFrom(value, fmt::format("{} expected: the groups of the cell's axes", FanucGroups(settings_)));
    scan.Expect(";");
  }

  /// "  12:L P[3] 10mm/sec FINE ;": number and ';' become blanks.
  void ReadStatement(LineScanner& scan) {
    if (scan.Peek() != ':') scan.ExpectDecimal();
    scan.Expect(":");
    const size_t begin = scan.Next();
    const std::string_view line = lines_[line_];
    const size_t end = line.rfind(';');
    if (end == std::string_view::npos || end < begin || !Trim(line.substr(end + 1)).empty())
      scan.Fail("a statement that ends in ';' on its own line expected");
    const std::string_view statement = Trim(line.substr(begin, end - begin));
    if (statement.find(';') != std::string_view::npos) scan.Fail("one statement in a line expected");
    if (statement.starts_with('/')) scan.Fail("a statement expected");
    statement_ = std::string(begin, ' ') + std::string(statement);
  }

  const std::string& file_;
  const std::string& stem_;
  const std::vector<std::string_view> lines_;
  const PostSettings& settings_;
  const FanucOptions& options_;
  std::vector<Problem>& problems_;
  FanucFile result_;
  std::string statement_;  // of the present line
  size_t line_ = 0;
  Part part_ = Part::kBefore;
  std::set<Part> seen_;
  bool named_ = false, grouped_ = false;
};

}  // namespace

FanucFile ReadFanucFile(const std::string& file, const std::string& stem, const std::string& text,
                        const PostSettings& settings, const FanucOptions& options,
                        std::vector<Problem>& problems) {
  return FileReader(file, stem, text, settings, options, problems).Read();
}

std::string FanucHead(const std::string& groups) {
  return fmt::format(
      "/PROG  {{name}}\n/ATTR\nOWNER = MNEDITOR;\nCOMMENT = \"millpose\";\nPROTECT = READ_WRITE;\n"
      "TCD:  STACK_SIZE = 0,\n      TASK_PRIORITY = 50,\n      TIME_SLICE = 0,\n      BUSY_LAMP_OFF = 0,\n"
      "      ABORT_REQUEST = 0,\n      PAUSE_REQUEST = 0;\nDEFAULT_GROUP = {};\n"
      "CONTROL_CODE = 00000000 00000000;\n/MN\n",
      groups);
}

}  // namespace millpose
