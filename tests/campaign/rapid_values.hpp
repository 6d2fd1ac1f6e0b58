// SPDX-License-Identifier: GPL-3.0-or-later
// RAPID's lexical elements, and values of its data types ("Lexical elements", "Aggregates").
#pragma once

#include <deque>

#include "tests/campaign/runner.hpp"

namespace millpose::campaign {

struct RapidToken {
  enum class Kind { kWord, kNumber, kString, kSign, kComment } kind = Kind::kSign;
  std::string text;  ///< words in upper case; of a comment its line
  double value = 0;
  int line = 0;
};

/// The tokens of a module in order.
class RapidStream {
 public:
  /// Refusal for what is no token.
  explicit RapidStream(const std::string& text);
  bool Done() const { return tokens_.empty(); }
  int Line() const { return tokens_.empty() ? 0 : tokens_.front().line; }
  /// Comments before it are passed over.
  bool Take(const std::string& text);
  void Need(const std::string& text);
  std::string Identifier();
  /// A comment that comes next and takes a whole line; empty: none does.
  std::string Comment();
  void SkipComments();
  /// What stands before `end`, which is taken.
  std::vector<RapidToken> Until(const std::string& end);

 private:
  std::deque<RapidToken> tokens_;
};

/// The tokens of one statement.
class RapidArguments {
 public:
  explicit RapidArguments(std::vector<RapidToken> tokens) : tokens_(std::move(tokens)) {}
  bool Sees(const std::string& text) const;
  bool Take(const std::string& text);
  void Need(const std::string& text);
  std::string Identifier();
  std::string String();
  /// With a sign; rounded to 24 bits.
  double Num();
  bool Truth();
  void End() const;
  /// "\V:=200\Inpos:=…": optional arguments as they stand; empty: none.
  std::string Switches();
  /// `word` and all that is left; numbers by their value.
  std::string Text(const std::string& word);

 private:
  std::vector<RapidToken> tokens_;
  size_t at_ = 0;
};

/// Of tooldata, wobjdata, speeddata, zonedata, robtarget, jointtarget, with what of each counts.
struct RapidValue {
  std::string type;
  Pose frame = Pose::Identity();  ///< of a tool, a target; oframe, or uframe·oframe
  Pose user = Pose::Identity();
  std::string unit = {};             ///< that carries a work object
  std::vector<double> numbers = {};  ///< speeds; zones; joints, deg; configuration; load
  std::vector<double> eax = {};
  bool fine = false;
};

/// An aggregate of the type. Refusal for anything else, and for a quaternion whose norm is not 1.
RapidValue ReadRapidValue(const std::string& type, RapidArguments& in);
/// vN, zN, fine: as the controller has them.
std::optional<RapidValue> PredefinedRapid(const std::string& type, const std::string& name);

}  // namespace millpose::campaign
