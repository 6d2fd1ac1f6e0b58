// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/rapid/rapid_module.hpp"

namespace millpose {
namespace {

void ReadNoParameters(LineScanner& scan) {
  scan.Expect("(");
  scan.Expect(")");
}

/// Speeds and zones are constants, tools and work objects persistents.
RapidDatum::Type ReadType(LineScanner& scan, bool constant) {
  using Type = RapidDatum::Type;
  if (scan.Accept(constant ? "speeddata" : "tooldata")) return constant ? Type::kSpeed : Type::kTool;
  scan.Expect(constant ? "zonedata" : "wobjdata");
  return constant ? Type::kZone : Type::kObject;
}

}  // namespace

RapidModuleReader::RapidModuleReader(const ProgramFiles& files, const PostSettings& settings,
                                     const RapidOptions& options)
    : ProgramReader(files, settings,
                    Templates(RapidTexts(settings), settings.texts, ToolOf(settings), {.numbers = false})),
      options_(options) {
  program_.blend_is_distance = true;
}

std::vector<Problem> RapidModuleReader::CheckTextsAlone() {
  texts_alone_ = true;
  return CheckTexts();
}

std::optional<std::string_view> RapidModuleReader::Comment(std::string_view line) const {
  return line.starts_with('!') ? std::optional(line.substr(1)) : std::nullopt;
}

/// A '!' within a text in quotes begins no comment.
std::string_view RapidModuleReader::WithoutComment(std::string_view line) const {
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (line[i] == '!' && !quoted) return line.substr(0, i);
  }
  return line;
}

void RapidModuleReader::ReadComment(std::string_view comment) {
  LineScanner scan = ScannerOf(comment);
  const bool begin = scan.Accept("PASS");
  if (!begin && !scan.Accept("END OF PASS")) return ProgramReader::ReadComment(comment);
  if (part_ != Part::kRoutine) scan.Fail("marks of passes are allowed in the program's procedure alone");
  ReadPassMark(scan, begin);
}

void RapidModuleReader::BeginFile() {
  part_ = texts_alone_ ? Part::kRoutine : Part::kBefore;
  data_.clear();
}

void RapidModuleReader::ReadCode(LineScanner& scan) {
  if (InText() && part_ != Part::kRoutine) scan.Fail("the cell's texts within the routine expected");
  switch (part_) {
    case Part::kBefore:
      return ReadModule(scan);
    case Part::kData:
      return ReadData(scan);
    case Part::kRoutine:
      if (!InText() && scan.Accept("ENDPROC")) return End(scan, Part::kBehind);
      ReadStatement(scan);
      scan.Expect(";");
      return scan.ExpectEnd();
    case Part::kBehind:
      return ReadBehind(scan);
    case Part::kMain:
      scan.Expect(FileStem());
      scan.Expect(";");
      return End(scan, Part::kMainCalled);
    case Part::kMainCalled:
      scan.Expect("ENDPROC");
      return End(scan, Part::kMainEnded);
    case Part::kMainEnded:
      scan.Expect("ENDMODULE");
      scan.ExpectEnd();
      return EndFile();
  }
}

void RapidModuleReader::End(LineScanner& scan, Part next) {
  scan.ExpectEnd();
  if (next == Part::kBehind && !loaded_.empty())
    scan.Fail(fmt::format("UnLoad of {} expected before the end", loaded_));
  part_ = next;
}

void RapidModuleReader::ReadModule(LineScanner& scan) {
  scan.Expect("MODULE");
  scan.Expect("mp_" + FileStem());
  if (!InSubprogram()) program_.name = FileStem();
  End(scan, Part::kData);
}

/// Behind the routine: main(), which calls it, of a program that stands by itself.
void RapidModuleReader::ReadBehind(LineScanner& scan) {
  if (scan.Accept("ENDMODULE")) {
    scan.ExpectEnd();
    return EndFile();
  }
  scan.Expect("PROC");
  if (InSubprogram()) scan.Fail("ENDMODULE expected: one main() is in the main program");
  scan.Expect("main");
  ReadNoParameters(scan);
  End(scan, Part::kMain);
}

/// LOCAL PERS tooldata NAME:=…; LOCAL CONST speeddata NAME:=…; or the routine.
void RapidModuleReader::ReadData(LineScanner& scan) {
  if (scan.Accept("PROC")) {
    scan.Expect(FileStem());
    ReadNoParameters(scan);
    return End(scan, Part::kRoutine);
  }
  scan.Expect("LOCAL");
  const bool constant = scan.Accept("CONST");
  if (!constant) scan.Expect("PERS");
  RapidDatum datum;
  datum.type = ReadType(scan, constant);
  const size_t start = scan.Next();
  const std::string name = Spelled(scan.AcceptName().value_or(""));
  if (!name.starts_with("MP_") || name.size() > 32)
    scan.FailFrom(start, "a name that begins with mp_ expected: the controller has data of other names");
  scan.Expect(":=");
  ReadValue(scan, datum);
  scan.Expect(";");
  scan.ExpectEnd();
  if (!data_.emplace(name, datum).second) scan.FailFrom(start, "a name that is not declared yet expected");
}

void RapidModuleReader::ReadValue(LineScanner& scan, RapidDatum& datum) {
  switch (datum.type) {
    case Type::kTool:
      datum.frame = rapid::ReadTool(scan, settings_.load.value_or(ToolLoad{}));
      break;
    case Type::kObject:
      datum.object =
          rapid::ReadWorkObject(scan, options_.work_unit ? options_.work_unit->name : std::string());
      break;
    case Type::kSpeed:
      datum.speed = rapid::ReadSpeed(scan);
      break;
    case Type::kZone:
      datum.zone = rapid::ReadZone(scan);
      break;
  }
}

bool RapidModuleReader::ReadLoading(LineScanner& scan, size_t start) {
  if (scan.Accept("Load")) {
    scan.Expect("\\");
    scan.Expect("Dynamic");
    scan.Expect(",");
    const std::string name = ReadPath(scan);
    if (!loaded_.empty()) scan.FailFrom(start, fmt::format("UnLoad of {} before it expected", loaded_));
    loaded_ = name;
    run_ = false;
  } else if (scan.Accept("%")) {
    scan.Expect("\"");
    const std::string name = scan.TakeUntil('"');
    scan.Expect("\"");
    scan.Expect("%");
    if (!SameWords(name, loaded_) || loaded_.empty() || run_)
      scan.FailFrom(start, "the module that was loaded last expected, once");
    run_ = true;
    if (!ReadSubprogram(scan, name)) scan.FailFrom(start, "a file of the program expected");
    return true;
  } else if (scan.Accept("UnLoad")) {
    const std::string name = ReadPath(scan);
    if (!SameWords(name, loaded_) || loaded_.empty() || !run_)
      scan.FailFrom(start, "the module that was loaded and has run expected");
    loaded_.clear();
  } else {
    return false;
  }
  Allow(scan, start, kAtStops);
  return true;
}

/// The name of a module in the cell's folder.
std::string RapidModuleReader::ReadPath(LineScanner& scan) const {
  const size_t start = scan.Next();
  scan.Expect("\"");
  const std::string path = scan.TakeUntil('"');
  scan.Expect("\"");
  if (options_.load_from.empty())
    scan.FailFrom(start, "no module expected: the cell gives no folder (load_from)");
  const std::string folder = options_.load_from + "/";
  if (path.size() < folder.size() + 5 || !SameWords(path.substr(0, folder.size()), folder) ||
      !SameWords(path.substr(path.size() - 4), ".mod"))
    scan.FailFrom(start, fmt::format("a module in {} (load_from) expected", options_.load_from));
  return path.substr(folder.size(), path.size() - folder.size() - 4);
}

bool RapidModuleReader::ReadSubprogram(LineScanner& scan, const std::string& name) {
  const auto data = std::exchange(data_, {});
  const std::string loaded = std::exchange(loaded_, {});
  const bool called = ReadCall(scan, name);
  data_ = data;
  loaded_ = loaded;
  part_ = Part::kRoutine;
  return called;
}

/// Of a persistent, whose value somebody else may have changed.
void RapidModuleReader::Assign(LineScanner& scan, size_t start, const std::string& name) {
  const auto found = data_.find(Spelled(name));
  const bool persistent =
      found != data_.end() && (found->second.type == Type::kTool || found->second.type == Type::kObject);
  if (!persistent) scan.FailFrom(start, "tooldata or wobjdata that this module declares expected");
  ReadValue(scan, found->second);
  Stated(ValueName(found->first));
  Allow(scan, start, kAtStops);
}

std::string RapidModuleReader::ValueName(const std::string& name) const {
  return fmt::format("the value of {} in {}", name, FileStem());
}

const RapidDatum& RapidModuleReader::DatumOf(LineScanner& scan, Type type, const char* what) {
  const size_t start = scan.Next();
  const std::string name = Spelled(scan.AcceptName().value_or(""));
  const auto found = data_.find(name);
  if (found == data_.end() || found->second.type != type)
    scan.FailFrom(start, fmt::format("{} that this module declares expected", what));
  if (type == Type::kTool || type == Type::kObject) Require(ValueName(name));
  return found->second;
}

}  // namespace millpose
