// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// One value of an APT statement with its place.
struct AptWord {
  std::string text;  ///< upper case, without spaces around it
  SourceLocation place;
};

/// "MAJOR/minor, minor" with its parts; a statement without a slash has no minors.
struct AptStatement {
  AptWord major;
  std::vector<AptWord> minors;
};

/// The statement's minors as numbers, `least` to `most` of them. Throws InputError.
std::vector<double> Numbers(const AptStatement& statement, size_t least, size_t most);

/// Splits CLDATA into statements: `$$` begins a comment, a `$` at the end of a line continues it, columns 73
/// to 80 are dropped where they hold a sequence number, letters become upper case.
class AptScanner {
 public:
  AptScanner(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  /// False at the end.
  bool Next(AptStatement& statement);
  /// The comments of whole lines before the statement that Next() returned, with their "$$".
  const std::vector<AptWord>& comments() const { return comments_; }

 private:
  std::string_view TakeLine();
  std::string_view WithoutSequenceNumber(std::string_view line);
  bool TakeComment(std::string_view line);

  std::string_view bytes_;
  std::string name_;
  size_t at_ = 0;
  int line_ = 0;
  std::vector<AptWord> comments_;
  bool cards_ = false;  // a line with a number in columns 73 to 80 was seen
};

}  // namespace millpose
