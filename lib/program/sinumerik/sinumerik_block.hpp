// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>

#include "program/scanner.hpp"

namespace millpose {

/// Characters of a block, comment included (SINUMERIK 840D sl, Programming Manual, Fundamentals: blocks).
inline constexpr size_t kLongestBlock = 512;

/// The words of one SINUMERIK block. The control refuses two words of one address and two G words of one
/// group, so does Accept().
class SinumerikBlock {
 public:
  static constexpr int kFrameGroup = 8, kAngleGroup = 50;

  /// `orientation`: the words of the tool's angles; `external`: names of the axes beside the robot's.
  SinumerikBlock(const std::array<std::string, 6>& axis_names, const std::array<std::string, 3>& orientation,
                 const std::vector<std::string>& external)
      : axis_names_(axis_names), orientation_(orientation), external_(external) {}

  /// Whether a word of this address, or this G word, means something else than an axis beside the robot's.
  static bool IsAddress(const std::string& name);

  /// Takes the word that comes next; false when it is none of a block's. InputError for what a block must not
  /// hold.
  bool Accept(LineScanner& scan);
  bool IsEmpty() const { return g_words_.empty() && m_codes_.empty() && words_.empty() && !tool_; }
  /// A statement was read that needs a block of its own: error when anything stands beside it.
  void StandsAlone(LineScanner& scan, size_t start) const;

  /// The G group of "G1", "ORIWKS", …; 0 for other words.
  static int GroupOf(const std::string& word);

  const std::vector<std::string>& g_words() const { return g_words_; }
  const std::vector<int>& m_codes() const { return m_codes_; }
  const std::optional<std::string>& tool() const { return tool_; }
  bool Has(const std::string& g_word) const;
  std::optional<double> Word(const std::string& address) const;
  std::optional<int> bits(const std::string& address) const;  ///< STAT, TU
  std::optional<double> pose(int i) const;                    ///< X, Y, Z mm, the tool's angles degrees
  std::string PoseWord(int i) const;                          ///< their addresses
  std::optional<double> axis(int i) const;                    ///< degrees
  bool HasPose() const;
  bool HasAxes() const;  ///< the robot's, or others
  bool HasRobotAxes() const;

 private:
  bool AcceptG(LineScanner& scan);
  bool AcceptM(LineScanner& scan);
  bool AcceptAddress(LineScanner& scan);
  void AddG(const LineScanner& scan, size_t start, const std::string& word);
  void Add(const LineScanner& scan, size_t start, const std::string& address, double value);

  const std::array<std::string, 6>& axis_names_;
  const std::array<std::string, 3>& orientation_;
  const std::vector<std::string>& external_;
  std::vector<std::string> g_words_;
  std::vector<int> m_codes_;
  std::map<std::string, double> words_;  // by address
  std::optional<std::string> tool_;
};

}  // namespace millpose
