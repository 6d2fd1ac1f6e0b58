// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <set>

#include "base/file.hpp"
#include "tests/audit/audit.hpp"
#include "tests/audit/good_folder.hpp"

namespace millpose::audit {

using Names = std::set<std::string>;

/// Adds `by` to the number that follows `name` in a line of a program.
inline std::string AddAfter(const std::string& line, const std::string& name, double by) {
  const size_t begin = line.find(name) + name.size();
  size_t used = 0;
  const double value = std::stod(line.substr(begin), &used);
  char text[40];
  std::snprintf(text, sizeof text, "%.6f", value + by);
  return line.substr(0, begin) + text + line.substr(begin + used);
}

/// Writes folders and has them judged.
class AuditTest : public testing::Test {
 protected:
  AuditTest()
      : top_(std::filesystem::temp_directory_path() / ("millpose_audit_test." + std::to_string(getpid()))) {
    std::filesystem::create_directories(top_);
  }
  ~AuditTest() override { std::filesystem::remove_all(top_); }

  Verdict Judged(const Texts& texts) {
    for (const auto& [name, text] : texts) {
      std::filesystem::create_directories((top_ / name).parent_path());
      WriteFileAtomically(top_ / name, text);
    }
    Options options;
    options.travel_mm = 25;
    return Audit(ReadFolder(top_ / "out"), options);
  }

  std::filesystem::path Path(const std::string& name) const { return top_ / name; }

  std::set<std::string> Broken(const Texts& texts) {
    const Verdict verdict = Judged(texts);
    std::set<std::string> names;
    for (const Figure& figure : verdict.figures)
      if (figure.value > figure.bound) names.insert(figure.name);
    return names;
  }

 private:
  std::filesystem::path top_;
};

}  // namespace millpose::audit
