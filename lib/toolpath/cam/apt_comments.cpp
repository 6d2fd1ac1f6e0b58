// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_comments.hpp"

#include <algorithm>
#include <set>

#include "base/text.hpp"

namespace millpose {
namespace {

// Words of comments that name a system of coordinates.
const std::set<std::string_view> kSystems{"CSYS",   "MCS",   "MSYS",  "WCS",      "UCS",
                                          "MATRIX", "FRAME", "COORD", "ORIGIN",   "TRANSL",
                                          "ROTATE", "DATUM", "MTRX",  "TRANSFORM"};

std::vector<std::string> WordsOf(std::string_view comment) {
  std::vector<std::string> words(1);
  for (const char c : comment.substr(2)) {
    const bool part = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' ||
                      c == '_' || c == '#';
    if (part)
      words.back() += c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  if (!words.empty() && words[0] == "-") words.erase(words.begin());  // "$$->"
  return words;
}

std::optional<double> NumberOf(std::string text) {
  if (text.starts_with('+')) text.erase(0, 1);
  return ParseNumber(text);
}

// All words as numbers; empty when one is none.
std::vector<double> AllNumbers(const std::vector<std::string>& words) {
  std::vector<double> numbers;
  for (const std::string& word : words) {
    const auto number = NumberOf(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// Rows of [axes | origin].
AptFrame FrameOf(const std::vector<double>& rows, std::string name, const SourceLocation& place) {
  AptFrame frame;
  for (Eigen::Index r = 0; r < 3; ++r) {
    const double* row = &rows[4 * static_cast<size_t>(r)];
    for (Eigen::Index c = 0; c < 3; ++c) frame.rotation(r, c) = row[c];
    frame.origin[r] = row[3];
  }
  frame.name = std::move(name);
  frame.place = place;
  constexpr double kRounded = 1e-3;  // five decimals are written
  if (!(frame.rotation * frame.rotation.transpose()).isIdentity(kRounded) ||
      !(frame.rotation.determinant() > 0))
    throw InputError(place, frame.name + ": the axes of the matrix are no right-handed unit vectors");
  // The last decimals: right angles again.
  Eigen::Matrix3d& axes = frame.rotation;
  axes.col(0).normalize();
  axes.col(2) = axes.col(0).cross(axes.col(1)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return frame;
}

bool IsIdentityIn(const std::vector<double>& numbers, std::initializer_list<double> identity) {
  return std::ranges::equal(numbers, identity, [](double a, double b) { return std::abs(a - b) <= 1e-9; });
}

// Every usual way of writing down that nothing is moved.
bool MovesNothing(const std::vector<double>& n) {
  return IsIdentityIn(n, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}) ||
         IsIdentityIn(n, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}) ||
         IsIdentityIn(n, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) ||
         IsIdentityIn(n, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}) ||
         IsIdentityIn(n, {0, 0, 0, 1, 0, 0, 0, 1, 0}) || IsIdentityIn(n, {1, 0, 0, 0, 1, 0, 0, 0, 1}) ||
         (!n.empty() && std::ranges::all_of(n, [](double v) { return v == 0; }));
}

}  // namespace

// What the job says of frames in comments, or what is known of the sender's.
std::optional<AptFrame> AptComments::Decide(AptFrame frame, bool known) {
  if (!frame.IsIdentity() && options_.frame) used_key_ = true;
  if (options_.frame == CamFrame::kAsGiven) return std::nullopt;
  if (known || frame.IsIdentity() || options_.frame == CamFrame::kStated) return frame;
  throw InputError(
      frame.place,
      frame.name == "CATIA0"
          ? "CATIA0 turns the axes, and whether its rows or its columns are the axes is not documented "
            "beyond "
            "doubt: state toolpath.cam.frame: stated when the columns are the axes of the machining system "
            "(the fourth its origin), or as_given when the points stand in the workpiece frame as they are "
            "written"
          : fmt::format("a comment names a system of coordinates ({}) that is not the file's own: "
                        "state toolpath.cam.frame: as_given when the points stand in the workpiece "
                        "frame as they are written{}",
                        frame.name,
                        frame.name == "CSYS" ? ", or stated when this system places them there" : ""));
}

// Whether rows and columns of its axes say the same: no turn, or half turns.
bool AptFrame::ReadsEitherWay() const { return rotation.isApprox(rotation.transpose(), 1e-9); }

// "$$*CATIA0", "$$ identifier", three rows of four numbers. Without a row nothing is stated.
std::optional<AptFrame> AptComments::TakeCatia(const std::vector<AptWord>& comments, size_t& at) {
  const SourceLocation place = comments[at].place;
  std::vector<double> rows;
  size_t others = 0;
  for (++at; at < comments.size() && rows.size() < 12; ++at) {
    if (comments[at].text.starts_with("$$*CATIA")) break;
    const std::vector<double> row = AllNumbers(WordsOf(comments[at].text));
    if (row.size() == 4)
      rows.insert(rows.end(), row.begin(), row.end());
    else if (!rows.empty() || ++others > 2)
      break;
  }
  --at;
  if (rows.empty()) return std::nullopt;
  if (rows.size() < 12)
    throw InputError(place,
                     fmt::format("CATIA0 needs three rows of four numbers, found {}", rows.size() / 4));
  AptFrame frame = FrameOf(rows, "CATIA0", place);
  const bool known = frame.ReadsEitherWay();
  return Decide(std::move(frame), known);
}

// A word for a system, its numbers behind it or in the comments that follow.
std::optional<AptFrame> AptComments::TakeOther(const std::vector<AptWord>& comments, size_t& at) {
  const std::vector<std::string> words = WordsOf(comments[at].text);
  const auto named = std::ranges::find_if(
      words.begin(), words.begin() + static_cast<long>(std::min<size_t>(3, words.size())),
      [](const std::string& word) { return kSystems.contains(word); });
  if (named == words.begin() + static_cast<long>(std::min<size_t>(3, words.size()))) return std::nullopt;
  const SourceLocation place = comments[at].place;
  std::vector<double> numbers;
  for (const std::string& word : words)
    if (const auto number = NumberOf(word)) numbers.push_back(*number);
  while (at + 1 < comments.size()) {
    const std::vector<double> more = AllNumbers(WordsOf(comments[at + 1].text));
    if (more.size() < 3) break;
    numbers.insert(numbers.end(), more.begin(), more.end());
    ++at;
  }
  if (numbers.size() < 3 || MovesNothing(numbers)) {
    if (numbers.size() != 12 || *named != "CSYS") return std::nullopt;
    return AptFrame{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), *named, place};
  }
  if (*named == "CSYS" && numbers.size() == 12) return Decide(FrameOf(numbers, *named, place), false);
  if (options_.frame == CamFrame::kAsGiven) {
    used_key_ = true;
    return std::nullopt;
  }
  AptFrame other{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Ones(), *named, place};
  if (options_.frame == CamFrame::kStated)
    throw InputError(place, fmt::format("a comment names a system of coordinates ({}) in a form that is not "
                                        "read; read are CATIA0 and CSYS with 12 numbers",
                                        *named));
  return Decide(std::move(other), false);
}

std::optional<AptFrame> AptComments::Take(const std::vector<AptWord>& comments) {
  std::optional<AptFrame> last;
  for (size_t at = 0; at < comments.size(); ++at) {
    const bool catia = comments[at].text.starts_with("$$*CATIA");
    if (auto frame = catia ? TakeCatia(comments, at) : TakeOther(comments, at)) last = std::move(frame);
  }
  return last;
}

}  // namespace millpose
