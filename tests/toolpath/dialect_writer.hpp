// SPDX-License-Identifier: GPL-3.0-or-later
// Random files in the dialects of their senders, written by writers that know what each sender means by its
// words, or that nobody can know it: the reader says the same, or refuses.
#pragma once

#include "base/error.hpp"
#include "tests/toolpath/generated_paths.hpp"

namespace millpose {

inline constexpr double kDialectChord = 0.02;

/// A tool at a speed, as the writer has set it.
struct Setting {
  std::string tool;
  double diameter = 0, rpm = 0;
  int sense = 0;
  bool operator==(const Setting&) const = default;
};

/// What both writers share: the text, what it means, and whether nobody can know what it means.
class DialectWriter {
 public:
  DialectWriter(uint64_t index, uint64_t seed) : random_(index, seed) {}

  /// Reads the file and compares; a file that must be refused and is read is a failure, so is the reverse.
  /// Returns whether it was read.
  bool Check(uint64_t index) {
    try {
      const CamPath read = ReadCamPath(text_, "generated", options_);
      EXPECT_EQ(why_refused_, "") << "file " << index << " is read\n" << text_;
      EXPECT_EQ(Difference(read, wants_, 1e-6, kDialectChord), "") << "file " << index << "\n" << text_;
      CheckSections(read, index);
      return true;
    } catch (const InputError& error) {
      EXPECT_NE(why_refused_, "") << "file " << index << ": " << error.what() << "\n" << text_;
      return false;
    }
  }

 protected:
  bool Chance(double share) { return random_.Chance(share); }
  double Between(double low, double high) { return random_.Between(low, high); }
  void Refuse(const std::string& why) {
    if (why_refused_.empty()) why_refused_ = why;
  }
  void Line(const std::string& line) { text_ += line + (Chance(0.05) ? "\r\n" : "\n"); }
  void Cut() {
    if (settings_.empty() || !(settings_.back() == now_)) settings_.push_back(now_);
  }

  WriterRandom random_;
  std::string text_, why_refused_;
  std::vector<Want> wants_;
  CamReadOptions options_;
  Setting now_;

 private:
  void CheckSections(const CamPath& read, uint64_t index) const {
    ASSERT_EQ(read.source.sections.size(), settings_.size()) << "file " << index << "\n" << text_;
    for (size_t i = 0; i < settings_.size(); ++i) {
      const CamSection& section = read.source.sections[i];
      EXPECT_EQ(section.tool, settings_[i].tool) << "file " << index << "\n" << text_;
      EXPECT_NEAR(section.diameter.value_or(0), settings_[i].diameter, 1e-6) << "file " << index << "\n"
                                                                             << text_;
      EXPECT_NEAR(60 * section.speed.value_or(0), settings_[i].rpm, 1e-6) << "file " << index << "\n"
                                                                          << text_;
      EXPECT_EQ(static_cast<int>(section.sense), settings_[i].sense) << "file " << index << "\n" << text_;
    }
  }

  std::vector<Setting> settings_;  // of the cuts, neighbours differ
};

/// Files of a dialect, one in `share` of those asked for.
template <class Dialect>
void ReadAll(uint64_t share) {
  uint64_t read = 0;
  const uint64_t count = std::max<uint64_t>(GeneratedCount() / share, 300);
  for (uint64_t i = 0; i < count; ++i) {
    read += Dialect(i).Check(i) ? 1 : 0;
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(read, count / 4) << "most files are refused";
  EXPECT_LT(read, count) << "no file is refused";
}

}  // namespace millpose
