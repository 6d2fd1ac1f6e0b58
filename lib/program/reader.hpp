// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of all controllers share: files that call each other, problems, marks, the cell's texts.
#pragma once

#include <set>

#include "program/post.hpp"
#include "program/scanner.hpp"
#include "program/templates.hpp"

namespace millpose {

/// Whether some line of `text` begins with the name `stem` as the call of a program does.
bool CallsProgram(std::string_view text, const std::string& stem);

/// Reads the files of one program line by line. A reader of a controller says what its lines mean.
class ProgramReader {
 public:
  ProgramReader(const ProgramFiles& files, const PostSettings& settings, Templates templates);
  virtual ~ProgramReader() = default;

  /// Reads the program that no other file calls among those that end in one of `extensions`, and what it
  /// calls. Throws InputError with every problem found.
  MotionProgram Read(const std::vector<std::string>& extensions);

 protected:
  /// A line that is a comment as a whole: its text.
  virtual std::optional<std::string_view> Comment(std::string_view line) const;
  /// The statements of a line; `scan` ends before a comment.
  virtual void ReadCode(LineScanner& scan) = 0;
  /// A comment, without what makes it one. Base: "key: value" in the head of the main program.
  virtual void ReadComment(std::string_view comment);
  /// A file of the program begins or has ended.
  virtual void BeginFile() {}
  /// What must be stated before the first motion: without it the motions depend on what ran before.
  virtual std::vector<std::string> Needed() const { return {}; }
  /// The cell's text `name` was read.
  virtual void TextRead(const std::string& /*name*/) {}

  /// Reads the sub-program `name`; Fail()s when there is no such file. Returns false when it is no call of
  /// one.
  bool ReadCall(LineScanner& scan, const std::string& name);
  /// The present file is complete.
  void EndFile() { ended_ = true; }
  bool InSubprogram() const { return open_.size() > 1; }
  std::string FileStem() const;

  /// One of Needed() was read.
  void Stated(const std::string& setting) { stated_.insert(setting); }
  Motion& AddMotion(MotionType type);
  void AddOutput(const PathOutput& output);
  /// What follows a pass mark, "3 PIECE 0"; the cell's text for it must come next, where there is one. Words
  /// that are no mark after all are somebody's comment.
  void ReadPassMark(LineScanner& scan, bool begin);

  const PostSettings& settings_;
  MotionProgram program_;

 private:
  void ReadFile(const std::string& name);
  size_t ReadAt(size_t i);
  size_t ReadTexts(size_t i);
  std::string MainFile();
  void AddEvent(ProgramEvent::Kind kind, double value, int piece);
  void ExpectStated();
  void ExpectTexts(const std::vector<std::string>& names);

  const ProgramFiles& files_;
  Templates templates_;
  std::vector<std::string> extensions_;
  std::vector<std::string> open_;  // files being read, the innermost last
  std::vector<Problem> problems_;
  std::vector<std::string_view> lines_;
  std::map<std::string, bool> seen_;    // texts of the cell
  std::set<std::string> stated_;        // settings
  std::optional<std::string> awaited_;  // the text that must come next
  int file_ = 0, line_ = 0;
  int pass_ = -1;
  bool ended_ = false;
};

}  // namespace millpose
