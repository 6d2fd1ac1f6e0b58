// SPDX-License-Identifier: GPL-3.0-or-later
// What the writers of all controllers share: the walk through a program, its sections and how they are packed
// into files, the head's comments, the cell's texts.
#pragma once

#include "program/post.hpp"
#include "program/templates.hpp"

namespace millpose {

/// Writes one program. A writer of a controller says how its lines look.
class ProgramWriter {
 public:
  virtual ~ProgramWriter() = default;

 protected:
  /// `texts`: the controller's own, which the cell's override. The arguments outlive the writer.
  ProgramWriter(const MotionProgram& program, const Arm& arm, const PostSettings& settings,
                std::map<std::string, std::string> texts);

  /// A section begins: modal settings are to be stated again, so that it can be entered.
  virtual void Begin() = 0;
  /// Nothing that was stated holds any longer: a text of the cell made a call.
  virtual void Forget() { Begin(); }
  virtual void Event(const ProgramEvent& event) = 0;
  /// Everything that a program states before its first motion: a declared call leaves it unknown. Each line
  /// with its end.
  virtual std::string Settings() const = 0;
  virtual void AddMotion(size_t i) = 0;

  /// Goes through motions and events in order. Sections end behind each kPassEnd and kHandover; the last one,
  /// which may be empty, holds what follows the last pass. Every other is one piece, or part of one, with the
  /// way to it.
  void WriteSections();
  /// Appends a line to the section that is being written.
  void Line(const std::string& line) { sections_.back().text += line + "\n"; }

  /// The sections packed into as few files as hold the settings' max_motions and max_bytes each, in order;
  /// one that is larger by itself has a file of its own. Empty when all fit into one: nothing need be split.
  std::vector<std::string> Parts() const;
  /// What the main program holds of the sections, where `parts` are files of their own.
  std::string MainText(const std::vector<std::string>& parts) const;

  /// "key: value" of the header, see HeaderLines().
  std::vector<std::string> HeaderTexts(size_t width) const;
  /// The lines of a text of the cell, each with its end, and the settings again behind a call. Empty for one
  /// whose call moves the arm, and for a change of tool away from home: it is written among the motions.
  std::string TextLines(const std::string& name) const;
  void AddText(const std::string& name);
  void AddTexts(const ProgramEvent& event);
  /// T of a joint motion to a pose, for the controller's tool frame as the text states it.
  int TurnAt(const Motion& motion, const Pose& X_PC_as_written) const;

  const MotionProgram& program_;
  const Arm& arm_;
  const PostSettings& settings_;
  Pose X_FT_;  ///< as the program states it, else as the cell does

 private:
  void AddLines(const std::vector<std::string>& lines, const std::string& name);

  struct Section {
    std::string text;
    int motions = 0;
  };
  Templates templates_;
  std::vector<Section> sections_;
};

/// `text` with '?' for every byte that is no printable ASCII character.
std::string PlainAscii(std::string text);

/// "key: value" as comments of at most `width` characters, plain ASCII. What does not fit goes on in further
/// ones under the same key; each ends at the end of a word, unless the word is longer than a line.
std::vector<std::string> HeaderLines(const std::string& key, const std::string& value, size_t width);

}  // namespace millpose
