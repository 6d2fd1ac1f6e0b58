// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of all controllers share: files that call each other, problems, marks, the cell's texts.
#pragma once

#include <set>

#include "program/post.hpp"
#include "program/program_place.hpp"
#include "program/scanner.hpp"
#include "program/templates.hpp"

namespace millpose {

/// Whether some line of `text` begins with the name `stem` as the call of a program does.
bool CallsProgram(std::string_view text, const std::string& stem);

/// Reads the files of one program line by line. A reader of a controller says what its lines mean, where
/// among the motions each statement may stand (Allow), and what a motion needs to be stated before it
/// (Needed, Require): whatever is neither modelled nor allowed at its place is a problem with its line.
class ProgramReader {
 public:
  ProgramReader(const ProgramFiles& files, const PostSettings& settings, Templates templates);
  virtual ~ProgramReader() = default;

  /// Reads the program that no other file calls among those that end in one of `extensions`, and what it
  /// calls. Throws InputError with every problem found.
  MotionProgram Read(const std::vector<std::string>& extensions);

  /// What no program may hold of the cell's texts: a statement that is neither modelled nor a word of texts
  /// nor a declared call. `place.file` is the text's name, line and column count within it.
  std::vector<Problem> CheckTexts();

 protected:
  /// A line that is a comment as a whole: its text.
  virtual std::optional<std::string_view> Comment(std::string_view line) const;
  /// A line without the comment at its end. Base: from ';' on.
  virtual std::string_view WithoutComment(std::string_view line) const;
  /// The statements of a line; `scan` ends before a comment.
  virtual void ReadCode(LineScanner& scan) = 0;
  /// A comment, without what makes it one. Base: "key: value" in the head of the main program.
  virtual void ReadComment(std::string_view comment);
  /// A file of the program begins or has ended.
  virtual void BeginFile() {}
  /// What must be stated before any motion: without it the motions depend on what ran before.
  virtual std::vector<std::string> Needed() const { return {}; }
  /// Nothing of what the program has set holds any longer, see Forget().
  virtual void Forgotten() {}
  /// Takes a word that only texts of the cell may hold (outputs, waits, spindle, coolant); false when another
  /// comes next. ReadCode() asks it while InText().
  virtual bool ReadTextWord(LineScanner& scan) = 0;
  /// Whether a line may stand behind the end of a file.
  virtual bool MayFollowEnd(std::string_view /*line*/) const { return false; }
  /// Most characters of a line, its comment included; 0: any number.
  virtual size_t LongestLine() const { return 0; }
  /// Lines from `first` on that the controller's writer writes as a whole: how many; 0 when there are none.
  virtual size_t ReadBlock(const std::vector<std::string_view>& /*lines*/, size_t /*first*/) { return 0; }
  /// The cell's text `name` was read.
  virtual void TextRead(const std::string& /*name*/) {}

  /// Reads the sub-program `name`; Fail()s when there is no such file. Returns false when it is no call of
  /// one.
  bool ReadCall(LineScanner& scan, const std::string& name);
  /// The present file is complete.
  void EndFile() { ended_ = true; }
  bool InSubprogram() const { return open_.size() > 1; }
  std::string FileStem() const;
  /// A scanner of `text`, which stands in the present line: its errors name file and line.
  LineScanner ScannerOf(std::string_view text) const { return {text, open_.back(), line_}; }

  /// Whether the cell declares a call of this name.
  bool IsDeclared(const std::string& name) const;
  /// What stands in brackets behind the name of a declared call, '(' taken: numbers, words, texts in quotes;
  /// returned as written by everybody alike.
  static std::string ReadArguments(LineScanner& scan);
  /// A call that the cell declares, with these arguments: what it does to settings is unknown, where it
  /// leaves the arm is known. False when `name` is no such call. The scanner stands behind name and
  /// arguments.
  bool ReadDeclaredCall(const LineScanner& scan, size_t start, const std::string& name,
                        const std::string& arguments);
  /// The line is one of a text of the cell.
  bool InText() const { return in_text_; }

  /// Something that happens here, unless a text of the cell does it: that is one event as a whole.
  void AddHandEvent(ProgramEvent::Kind kind, std::string_view text);
  /// A stop, a wait, a message: what was read from `start` on, which may stand at `places` alone.
  void ReadHandEvent(const LineScanner& scan, size_t start, ProgramEvent::Kind kind, Places places);
  /// A wait for so many seconds, read from `start` on.
  void ReadDwell(const LineScanner& scan, size_t start, double seconds);
  /// What was read from `start` on may stand at `places` alone; told at the end, when it is known where it
  /// stands.
  void Allow(const LineScanner& scan, size_t start, Places places);
  /// A label of the present file; each may stand once.
  void AddLabel(const LineScanner& scan, size_t start, const std::string& name);

  /// A setting was read: it holds from here on.
  void Stated(const std::string& setting) { stated_.insert(setting); }
  /// Nothing of what was stated holds any longer, because of `by` (a call, a reset).
  void Forget(const std::string& by);
  /// The motion that is being read needs `setting` to be stated. Told once.
  void Require(const std::string& setting);
  /// No motion was read so far.
  bool InHead() const { return program_.motions.empty(); }
  Motion& AddMotion(MotionType type);
  void AddOutput(const PathOutput& output);
  /// What follows a pass mark, "3 PIECE 0"; the cell's text for it must come next, where there is one. Words
  /// that are no mark after all are somebody's comment.
  void ReadPassMark(LineScanner& scan, bool begin);

  const PostSettings& settings_;
  MotionProgram program_;
  ExternalPosition external_;  ///< where the external axes stand, as the motions read so far leave them

 private:
  void ReadFile(const std::string& name);
  size_t ReadAt(size_t i);
  size_t ReadTexts(size_t i);
  size_t ReadText(const std::string& name, size_t i);
  void ReadTextLines(size_t i, size_t count);
  void AllowText(const std::string& name);
  bool IsChangeByHand() const;
  void AddChangeByHand();
  std::string MainFile();
  void AddEvent(ProgramEvent::Kind kind, double value, int piece);
  void AddCall(const DeclaredCall& call, const std::string& arguments);
  void ExpectTexts(const std::vector<std::string>& names);

  const ProgramFiles& files_;
  Templates templates_;
  std::vector<std::string> extensions_;
  std::vector<std::string> open_;  // files being read, the innermost last
  std::vector<Problem> problems_;
  std::vector<std::string_view> lines_;
  std::map<std::string, bool> seen_;  // texts of the cell
  std::set<std::string> stated_;      // settings
  std::set<std::string> labels_;      // of the present file, upper case
  std::string forgotten_by_;          // what made the settings unknown, where something did
  PlaceRules rules_;
  std::optional<std::string> awaited_;  // the text that must come next
  int file_ = 0, line_ = 0;
  int pass_ = -1;
  bool ended_ = false;
  bool in_text_ = false;
  bool checking_ = false;  // texts alone, without a program
};

}  // namespace millpose
