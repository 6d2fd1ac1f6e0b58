// SPDX-License-Identifier: GPL-3.0-or-later
// What the campaign's interpreters share: the arm that moves, and a cursor over a line of their own.
#pragma once

#include <optional>
#include <string_view>

#include "tests/campaign/trace.hpp"

namespace millpose::campaign {

/// The control stops with an error before or at this line.
struct Refusal {
  std::string why;
};

/// A cursor over one line in upper case. Everything returns empty (false) and stays where it is when
/// something else comes next.
class Cursor {
 public:
  explicit Cursor(std::string line) : line_(std::move(line)) {}

  bool Done();
  char Peek();                       ///< the next character that is no blank; '\0' at the end
  bool AtBlank() const;              ///< a blank comes next
  bool Take(std::string_view text);  ///< a word, not the beginning of a longer one
  bool TakeChar(char c);
  /// Digits, '.', a sign; with `exponent` also E and a whole number.
  std::optional<double> Number(bool exponent = false);
  std::optional<int> Bits();                         ///< 'B0101'
  std::string Name();                                ///< letters, digits, '_', '$', '.'; empty: none
  std::optional<std::string> Quoted();               ///< between two "
  std::string Rest();                                ///< all that follows
  void Need(bool happened, const char* what) const;  ///< Refusal unless it happened

 private:
  void Blanks();
  std::string line_;
  size_t at_ = 0;
};

std::string Upper(std::string text);
/// Without the blanks that part no words.
std::string Squeezed(const std::string& code);
std::vector<std::string> LinesOf(const std::string& text);

/// The arm as it is moved, and what it did.
class Mover {
 public:
  explicit Mover(const Machine& machine) : machine_(machine) {}

  /// All joints together to `q`.
  Step& WayTo(const Joints& q);
  /// Likewise to a flange pose on the branch S with the signs T (bit i set: joint i + 1 negative); where one
  /// is missing, the present one holds.
  Step& WayTo(const Pose& X_BF, std::optional<int> status, std::optional<int> turn);
  /// The tip straight to a flange pose, on the present branch.
  Step& CutTo(const Pose& X_BF);
  /// The joints together at a feed.
  Step& TimedTo(const Joints& q);
  /// What is no motion.
  Step& Event(Step::Kind kind, const std::string& words);
  /// What a line says to whoever looks at the program: the mark of a pass, in a comment or a message.
  void Mark(const std::string& text);
  /// The call of a program of the plant, with what stands in its brackets.
  void PlantCall(const std::string& name, const std::string& arguments);

  const std::optional<Joints>& q() const { return q_; }
  int line = 0;
  Trace trace;

 protected:
  const Machine& machine_;
  std::map<std::string, double> external_;  ///< where the axes beside the arm's stand, mm or deg

 private:
  Step& Add(Step::Kind kind, const Joints& q);
  std::optional<Joints> q_;
};

Pose Frame(double x, double y, double z, const Eigen::Matrix3d& R);
/// R = Rz(a)·Ry(b)·Rx(c), degrees.
Eigen::Matrix3d Zyx(double a, double b, double c);
/// SINUMERIK's and LinuxCNC's A, B, C (degrees): rpy Rz(C)·Ry(B)·Rx(A), euler Rz(A)·Rx(B)·Rz(C).
Eigen::Matrix3d Oriented(const std::string& rotation, double a, double b, double c);

}  // namespace millpose::campaign
