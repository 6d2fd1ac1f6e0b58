// SPDX-License-Identifier: GPL-3.0-or-later
// What a RAPID module is made of: its data, its routine, main(), and how modules call each other.
#pragma once

#include "program/rapid/rapid.hpp"
#include "program/rapid/rapid_data.hpp"
#include "program/reader.hpp"

namespace millpose {

/// What a module has declared.
struct RapidDatum {
  enum class Type : uint8_t { kTool, kObject, kSpeed, kZone } type = Type::kTool;
  Pose frame = Pose::Identity();  ///< of a tool, as it was assigned last
  rapid::WorkObject object;       ///< likewise
  rapid::Speed speed;
  double zone = 0;  ///< mm
};

/// Reads the modules of a program; what derives from it reads the statements of their routines.
class RapidModuleReader : public ProgramReader {
 public:
  RapidModuleReader(const ProgramFiles& files, const PostSettings& settings, const RapidOptions& options);
  /// Texts alone, without a module round them.
  std::vector<Problem> CheckTextsAlone();

 protected:
  using Type = RapidDatum::Type;

  std::optional<std::string_view> Comment(std::string_view line) const override;
  std::string_view WithoutComment(std::string_view line) const override;
  void ReadComment(std::string_view comment) override;
  void BeginFile() override;
  void ReadCode(LineScanner& scan) override;
  /// A statement of a routine, up to its ';'.
  virtual void ReadStatement(LineScanner& scan) = 0;

  /// Load \Dynamic,"FOLDER/NAME.mod"; %"NAME"%; UnLoad "FOLDER/NAME.mod": one behind the other. False when
  /// none of them comes next.
  bool ReadLoading(LineScanner& scan, size_t start);
  bool ReadSubprogram(LineScanner& scan, const std::string& name);
  /// A value for a persistent, which somebody else may have changed; ":=" is taken.
  void Assign(LineScanner& scan, size_t start, const std::string& name);
  /// What comes next must be data of the type that the module declares, persistents with a value. `what`: for
  /// messages.
  const RapidDatum& DatumOf(LineScanner& scan, Type type, const char* what);

  const RapidOptions& options_;

 private:
  enum class Part : uint8_t { kBefore, kData, kRoutine, kBehind, kMain, kMainCalled, kMainEnded };

  void End(LineScanner& scan, Part next);
  void ReadModule(LineScanner& scan);
  void ReadBehind(LineScanner& scan);
  void ReadData(LineScanner& scan);
  void ReadValue(LineScanner& scan, RapidDatum& datum);
  std::string ReadPath(LineScanner& scan) const;
  std::string ValueName(const std::string& name) const;

  std::map<std::string, RapidDatum> data_;  // of the present module
  std::string loaded_;                      // module that is in memory
  bool run_ = false;                        // it was called
  Part part_ = Part::kBefore;
  bool texts_alone_ = false;
};

}  // namespace millpose
