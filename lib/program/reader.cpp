// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/reader.hpp"

namespace millpose {
namespace {

constexpr size_t kDeepestCall = 8;
constexpr size_t kMostCalls = 10000;  // in all: programs that call others twice each grow without end

std::string Stem(const std::string& file) { return file.substr(0, file.rfind('.')); }

bool EndsInOneOf(const std::string& file, const std::vector<std::string>& extensions) {
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return file.ends_with(e); });
}

}  // namespace

bool CallsProgram(std::string_view text, const std::string& stem) {
  for (const std::string_view line : SplitLines(text)) {
    LineScanner scan(line, "", 0);
    if (scan.AcceptAddress('N')) scan.ExpectNumber();
    scan.Accept("CALL");
    if (scan.Accept("%\"")) {  // RAPID, of a module that is loaded as the program runs
      if (scan.Accept(stem) && scan.Peek() == '"') return true;
      continue;
    }
    if (scan.Accept(stem) && (scan.AtEnd() || scan.Peek() == '(' || scan.Peek() == ';')) return true;
  }
  return false;
}

namespace {

/// So many motions the texts have at the most, but for loops: each is a line of its own.
size_t MostMotions(const ProgramFiles& files) {
  constexpr size_t kFewestBytes = 16;  // of a motion: texts may be of blank lines
  size_t most = 0;
  for (const auto& [name, text] : files)
    most += std::min(static_cast<size_t>(std::ranges::count(text, '\n')), text.size() / kFewestBytes);
  return most;
}

}  // namespace

ProgramReader::ProgramReader(const ProgramFiles& files, const PostSettings& settings, Templates templates)
    : settings_(settings),
      external_(settings.mechanism.axes().size(), 0),
      files_(files),
      templates_(std::move(templates)) {
  program_.axes = settings.axes;
  program_.external_axes = settings.mechanism.axes();
  program_.switches_spindle = !templates_.Lines("spindle_on").empty();
  if (!external_.empty()) program_.X_WB = settings.X_WB;
}

MotionProgram ProgramReader::Read(const std::vector<std::string>& extensions) {
  extensions_ = extensions;
  const std::string main = MainFile();
  program_.name = Stem(main);
  program_.motions.reserve(MostMotions(files_));
  ReadFile(main);
  ExpectTexts({"header", "tool_change", "footer"});
  const std::vector<Problem> broken = rules_.Broken(program_);
  problems_.insert(problems_.end(), broken.begin(), broken.end());
  if (problems_.empty()) return std::move(program_);
  const auto order = [&](const Problem& problem) {
    const auto& files = program_.files;
    return std::pair(std::find(files.begin(), files.end(), problem.place.file) - files.begin(),
                     problem.place.line);
  };
  std::stable_sort(problems_.begin(), problems_.end(),
                   [&](const Problem& a, const Problem& b) { return order(a) < order(b); });
  throw InputError(problems_);
}

std::string ProgramReader::MainFile() {
  std::vector<std::string> mains;
  for (const auto& [name, text] : files_) {
    if (!EndsInOneOf(name, extensions_)) continue;
    const std::string stem = Stem(name);
    const bool called = std::any_of(files_.begin(), files_.end(), [&, &own = name](const auto& other) {
      return other.first != own && EndsInOneOf(other.first, extensions_) && CallsProgram(other.second, stem);
    });
    if (!called) mains.push_back(name);
  }
  if (mains.size() == 1) return mains[0];
  if (mains.empty())
    throw InputError(SourceLocation{}, fmt::format("no main program ending in {} given", extensions_[0]));
  throw InputError(
      SourceLocation{mains[1], 1, 0, -1},
      fmt::format("one main program expected, but none of {} calls the other", fmt::join(mains, ", ")));
}

void ProgramReader::ReadFile(const std::string& name) {
  open_.push_back(name);
  program_.files.push_back(name);
  file_ = static_cast<int>(program_.files.size()) - 1;
  lines_ = SplitLines(files_.at(name));
  ended_ = false;
  const std::set<std::string> labels_outside = std::exchange(labels_, {});
  BeginFile();
  for (size_t i = 0; i < lines_.size();) {
    try {
      i += ReadAt(i);
    } catch (const InputError& error) {
      problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
      ++i;
    }
  }
  if (!ended_)
    problems_.push_back(
        {{name, static_cast<int>(lines_.size()), 0, -1}, "the end of the program is missing"});
  labels_ = labels_outside;
  open_.pop_back();
}

size_t ProgramReader::ReadAt(size_t i) {
  line_ = static_cast<int>(i) + 1;
  if (const size_t taken = ReadBlock(lines_, i)) return taken;
  if (const size_t taken = ReadTexts(i)) return taken;
  const std::string_view line = Trim(lines_[i]);
  if (LongestLine() > 0 && lines_[i].size() > LongestLine())
    problems_.push_back(
        {{open_.back(), line_, 0, -1},
         fmt::format("lines of at most {} characters expected, comments included", LongestLine())});
  if (line.empty()) return 1;
  if (awaited_) {
    problems_.push_back(
        {{open_.back(), line_, 0, -1}, fmt::format("the cell's text {} expected", *awaited_)});
    awaited_.reset();
  }
  if (const auto comment = Comment(line)) {
    ReadComment(*comment);
    return 1;
  }
  LineScanner scan(WithoutComment(lines_[i]), open_.back(), line_);
  if (ended_ && !MayFollowEnd(line)) scan.Fail("nothing expected after the end of the program");
  ReadCode(scan);
  return 1;
}

std::optional<std::string_view> ProgramReader::Comment(std::string_view line) const {
  return line.starts_with(';') ? std::optional(line.substr(1)) : std::nullopt;
}

std::string_view ProgramReader::WithoutComment(std::string_view line) const {
  return line.substr(0, line.find(';'));
}

void ProgramReader::ReadComment(std::string_view comment) {
  const size_t colon = comment.find(": ");
  const bool in_head = program_.motions.empty() && program_.events.empty();
  if (!in_head || InSubprogram() || colon == std::string_view::npos) return;
  const std::string_view key = Trim(comment.substr(0, colon));
  if (key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") != std::string_view::npos) return;
  program_.header.emplace_back(key, Trim(comment.substr(colon + 2)));
}

bool ProgramReader::ReadCall(LineScanner& scan, const std::string& name) {
  std::string file;
  for (const auto& [other, text] : files_) {
    if (EndsInOneOf(other, extensions_) && SameWords(Stem(other), name)) file = other;
  }
  if (file.empty()) return false;
  if (open_.size() > kDeepestCall || std::find(open_.begin(), open_.end(), file) != open_.end()) {
    scan.Fail("programs must not call each other in a circle");
  }
  if (program_.files.size() > kMostCalls) scan.Fail("fewer calls of programs expected");
  rules_.Add({open_.back(), line_, 0, -1}, fmt::format("the call of {}", name), program_.motions.size(),
             kAtStops);
  const std::vector<std::string_view> lines = lines_;
  const int index = file_, line = line_;
  if (pass_ >= 0 && !program_.motions.empty()) AddEvent(ProgramEvent::Kind::kHandover, 0, 0);
  ReadFile(file);
  lines_ = lines;
  file_ = index;
  line_ = line;
  ended_ = false;
  return true;
}

std::string ProgramReader::FileStem() const { return Stem(open_.back()); }

void ProgramReader::Allow(const LineScanner& scan, size_t start, Places places) {
  rules_.Add(scan.PlaceOf(start), fmt::format("'{}'", scan.TakenFrom(start)), program_.motions.size(),
             places);
}

void ProgramReader::AddHandEvent(ProgramEvent::Kind kind, std::string_view text) {
  if (in_text_) return;
  AddEvent(kind, 0, 0);
  program_.events.back().text = Spelled(text);
}

void ProgramReader::ReadHandEvent(const LineScanner& scan, size_t start, ProgramEvent::Kind kind,
                                  Places places) {
  Allow(scan, start, places);
  AddHandEvent(kind, scan.TakenFrom(start));
}

void ProgramReader::ReadDwell(const LineScanner& scan, size_t start, double seconds) {
  Allow(scan, start, kAtStops);
  AddEvent(ProgramEvent::Kind::kDwell, seconds, 0);
}

void ProgramReader::AddLabel(const LineScanner& scan, size_t start, const std::string& name) {
  std::string upper = name;
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  if (!labels_.insert(upper).second)
    scan.FailFrom(start, "a label that this file does not have yet expected");
}

void ProgramReader::Forget(const std::string& by) {
  stated_.clear();
  forgotten_by_ = InHead() ? "" : by;
  Forgotten();
}

void ProgramReader::Require(const std::string& setting) {
  if (checking_ || !stated_.insert(setting).second) return;  // reported once
  problems_.push_back({{open_.back(), line_, 0, -1},
                       forgotten_by_.empty()
                           ? fmt::format("{} must be stated before the first motion", setting)
                           : fmt::format("{} must be stated again before this motion: {} left it unknown",
                                         setting, forgotten_by_)});
}

Motion& ProgramReader::AddMotion(MotionType type) {
  for (const std::string& setting : Needed()) Require(setting);
  Motion& motion = program_.motions.emplace_back();
  motion.type = type;
  motion.external = external_;
  motion.pass = pass_;
  motion.file = file_;
  motion.line = line_;
  return motion;
}

void ProgramReader::ReadPassMark(LineScanner& scan, bool begin) {
  double pass = 0, number = 0;
  try {
    pass = scan.ExpectNumber();
    scan.Expect("PIECE");
    number = scan.ExpectNumber();
  } catch (const InputError&) {
    return;
  }
  if (pass != std::floor(pass) || number != std::floor(number))
    scan.Fail("whole numbers expected in the mark of a pass");
  const int piece = static_cast<int>(number);
  AddEvent(begin ? ProgramEvent::Kind::kPassBegin : ProgramEvent::Kind::kPassEnd, pass, piece);
  pass_ = begin ? static_cast<int>(pass) : -1;
  const std::string name = begin ? "pass_begin" : "pass_end";
  if (!templates_.Lines(name).empty()) awaited_ = name;
}

void ProgramReader::AddOutput(const PathOutput& output) {
  AddEvent(ProgramEvent::Kind::kOutput, 0, 0);
  program_.events.back().output = output;
}

void ProgramReader::AddEvent(ProgramEvent::Kind kind, double value, int piece) {
  program_.events.push_back({kind, program_.motions.size(), value, piece, {}, file_, line_, {}, {}});
}

}  // namespace millpose
