// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/mutations.hpp"

#include <fmt/format.h>

#include <cctype>
#include <utility>

#include "tests/campaign/runner.hpp"

namespace millpose::campaign {
namespace {

using Lines = std::vector<std::string>;

const Vocabulary& VocabularyOf(const std::string& controller) {
  if (controller == "krl") return KrlVocabulary();
  if (controller == "urscript") return UrScriptVocabulary();
  if (controller == "fanuc") return FanucVocabulary();
  if (controller == "rapid") return RapidVocabulary();
  return controller == "sinumerik" ? SinumerikVocabulary() : LinuxCncVocabulary();
}

class Mutator {
 public:
  Mutator(const Files& files, const Files& other, const std::string& controller, RandomStream& random)
      : random_(random), other_(other), vocabulary_(VocabularyOf(controller)) {
    mutant_.files = files;
    size_t pick = Index(files.size());
    for (const auto& [name, text] : files) {
      if (pick-- == 0) mutant_.file = name;
    }
    if (mutant_.file.ends_with(".dat")) mutant_.file.replace(mutant_.file.size() - 3, 3, "src");
    const std::string& text = files.at(mutant_.file);
    lines_ = LinesOf(text);
    if (lines_.back().empty()) lines_.pop_back();
  }

  Mutant Make() {
    for (int tries = 0; tries < 100; ++tries) {
      at_ = Index(lines_.size());
      Lines changed = lines_;
      mutant_.kind.clear();
      code_ = false;
      const size_t reach = Index(10);
      if (reach == 0)
        WholeProgram(changed);
      else
        Change(changed);
      if (reach == 1 && !mutant_.kind.empty() && !changed.empty()) {
        const std::string first = std::exchange(mutant_.kind, "");
        at_ = Index(changed.size());
        Change(changed);
        mutant_.kind = "two: " + first + ", " + mutant_.kind;
        at_ = std::min(at_, lines_.size() - 1);
      }
      if (mutant_.kind.empty() || changed == lines_) continue;
      std::string text;
      for (const std::string& one : changed) text += one + end_;
      mutant_.line = static_cast<int>(at_) + 1;
      mutant_.before = lines_[at_];
      mutant_.after = at_ < changed.size() ? changed[at_] : "";
      mutant_.files[mutant_.file] = text;
      break;
    }
    return std::move(mutant_);
  }

 private:
  size_t Index(size_t count) { return static_cast<size_t>(random_.Below(static_cast<int>(count))); }

  void Change(Lines& lines) {
    const size_t pick = Index(20);
    if (pick < 6) return Number(lines[at_]);
    if (pick < 9) return Insert(lines);
    if (pick < 13) return MoveLines(lines);
    if (pick < 16) return Words(lines[at_]);
    Queries(lines);
  }

  /// One change all through the program, or a part of another one.
  void WholeProgram(Lines& lines) {
    switch (Index(6)) {
      case 0: {
        const auto& [from, to] = vocabulary_.words[Index(vocabulary_.words.size())];
        Name("all: word " + from + " -> " + to);
        for (std::string& line : lines)
          if (const size_t place = line.find(from); place != std::string::npos)
            line.replace(place, from.size(), to);
        break;
      }
      case 1:
        return AllNumbers(lines);
      case 2: {
        const std::string word = lines_[at_].substr(0, lines_[at_].find_first_of(" ,(="));
        if (word.empty()) return;
        Name("all: lines dropped that begin alike");
        std::erase_if(lines, [&](const std::string& line) { return line.starts_with(word); });
        break;
      }
      case 3: {
        const size_t end = std::min(lines.size(), at_ + 1 + Index(20)), to = Index(lines.size());
        Name("block moved");
        const Lines block(lines.begin() + static_cast<long>(at_), lines.begin() + static_cast<long>(end));
        lines.erase(lines.begin() + static_cast<long>(at_), lines.begin() + static_cast<long>(end));
        lines.insert(lines.begin() + static_cast<long>(std::min(to, lines.size())), block.begin(),
                     block.end());
        break;
      }
      case 4: {
        const size_t end = std::min(lines.size(), at_ + 1 + Index(20));
        Name("block dropped");
        lines.erase(lines.begin() + static_cast<long>(at_), lines.begin() + static_cast<long>(end));
        break;
      }
      default: {
        const auto found = other_.find(mutant_.file);
        if (found == other_.end()) return;
        Name("file of another plan");
        Lines others = LinesOf(found->second);
        if (others.back().empty()) others.pop_back();
        const size_t keep = Index(2) ? at_ : 0;
        lines.resize(std::min(keep, lines.size()));
        if (keep < others.size())
          lines.insert(lines.end(), others.begin() + static_cast<long>(keep), others.end());
      }
    }
  }

  /// Every number behind the word that stands before one of the line.
  void AllNumbers(Lines& lines) {
    const std::string& line = lines_[at_];
    const size_t digit = line.find_first_of("0123456789", Index(line.size() + 1));
    if (digit == std::string::npos || digit == 0) return;
    size_t begin = digit;
    while (begin > 0 && line[begin - 1] != ',' && line[begin - 1] != '{' && digit - begin < 3) --begin;
    const std::string word = line.substr(begin, digit - begin);
    static const std::vector<double> steps = {1e-5, 1e-3, 0.01, 0.03, 1, 1000};
    const double step = steps[Index(steps.size())];
    Name(fmt::format("all: number +- {}", step));
    for (std::string& one : lines) {
      const size_t at = one.find(word);
      if (at == std::string::npos) continue;
      const size_t from = at + word.size(),
                   to = std::min(one.find_first_not_of("0123456789.", from), one.size());
      if (from == to) continue;
      one.replace(from, to - from,
                  fmt::format("{:.6f}", std::strtod(one.substr(from, to - from).c_str(), nullptr) + step));
    }
  }

  /// A number of the line, changed in one of many ways.
  void Number(std::string& line) {
    std::vector<std::pair<size_t, size_t>> numbers;
    for (size_t i = 0; i < line.size(); ++i) {
      if (!std::isdigit(static_cast<unsigned char>(line[i]))) continue;
      const size_t begin = i;
      while (i < line.size() && (std::isdigit(static_cast<unsigned char>(line[i])) || line[i] == '.')) ++i;
      numbers.emplace_back(begin, i - begin);
    }
    if (numbers.empty()) return;
    const auto [begin, length] = numbers[Index(numbers.size())];
    const std::string before = line.substr(0, begin);
    code_ = before.find_last_of("GM") + 1 == begin && begin > 0;
    std::string text = line.substr(begin, length);
    const double value = std::strtod(text.c_str(), nullptr);
    static const std::vector<double> steps = {1e-6, 1e-5, 1e-4, 1e-3, 0.004, 0.01, 0.03, 0.1, 1, 30, 1000};
    switch (Index(9)) {
      case 0:
      case 1:
      case 2: {
        const double step = steps[Index(steps.size())];
        Name(fmt::format("number +- {}", step));
        text = fmt::format("{:.6f}", value + (random_.Uniform() < 0.5 ? step : -step));
        break;
      }
      case 3:
        Name("digit changed"), Digit(text);
        break;
      case 4:
        Name("digit dropped"), text.erase(Index(text.size()), 1);
        break;
      case 5:
        Name("digit doubled"), text.insert(Index(text.size()), 1, text[Index(text.size())]);
        break;
      case 6:
        Name("point lost"), text.erase(std::remove(text.begin(), text.end(), '.'), text.end());
        break;
      case 7:
        return Sign(line, begin);
      default:
        Name("exponent"), text += Index(2) ? "e3" : "E-5";
        break;
    }
    line.replace(begin, length, text);
  }

  void Digit(std::string& text) {
    const size_t i = Index(text.size());
    if (text[i] != '.') text[i] = static_cast<char>('0' + Index(10));
  }

  void Sign(std::string& line, size_t begin) {
    Name("sign");
    if (begin > 0 && line[begin - 1] == '-')
      line.erase(begin - 1, 1);
    else
      line.insert(begin, "-");
  }

  void Insert(Lines& lines) {
    const std::string& statement = vocabulary_.statements[Index(vocabulary_.statements.size())];
    Name("insert " + statement);
    lines.insert(lines.begin() + static_cast<long>(at_), statement);
  }

  void MoveLines(Lines& lines) {
    const auto line = lines.begin() + static_cast<long>(at_);
    const size_t other = Index(lines.size());
    switch (Index(6)) {
      case 0:
        Name("line dropped"), lines.erase(line);
        break;
      case 1:
        Name("line doubled"), lines.insert(line, std::string(*line));
        break;
      case 2:
        if (at_ + 1 == lines.size()) return;
        Name("lines swapped"), std::swap(*line, *(line + 1));
        break;
      case 3: {
        Name("line moved");
        const std::string moved = *line;
        lines.erase(line);
        lines.insert(lines.begin() + static_cast<long>(std::min(other, lines.size())), moved);
        break;
      }
      case 4:
        Name("line copied"), lines.insert(line, lines_[other % lines_.size()]);
        break;
      default:
        Name("line replaced"), *line = lines_[other % lines_.size()];
        break;
    }
  }

  /// A word of the line changed, dropped, doubled, taken from another line.
  void Words(std::string& line) {
    const size_t space = line.find_first_of(" ,", Index(std::max<size_t>(1, line.size())));
    switch (Index(5)) {
      case 0:
      case 1: {
        const auto& [from, to] = vocabulary_.words[Index(vocabulary_.words.size())];
        const size_t place = line.find(from);
        if (place == std::string::npos) return;
        Name("word " + from + " -> " + to);
        line.replace(place, from.size(), to);
        break;
      }
      case 2: {
        if (space == std::string::npos) return;
        Name("word dropped");
        const size_t end = line.find_first_of(" ,", space + 1);
        line.erase(space, end == std::string::npos ? end : end - space);
        break;
      }
      case 3: {
        if (space == std::string::npos) return;
        Name("word doubled");
        const size_t end = line.find_first_of(" ,", space + 1);
        const std::string word = line.substr(space, end == std::string::npos ? end : end - space);
        line.insert(space, word);
        break;
      }
      default: {
        const size_t bits = line.find("'B");
        if (bits == std::string::npos) return;
        Name("bit");
        size_t place = line.find("'B", Index(2) ? bits + 1 : bits);
        if (place == std::string::npos) place = bits;
        char& bit = line[place + 2 + Index(3)];
        if (bit == '0' || bit == '1') bit = bit == '0' ? '1' : '0';
      }
    }
  }

  /// What should change nothing, most of it.
  void Queries(Lines& lines) {
    std::string& line = lines[at_];
    const size_t place = Index(line.size() + 1);
    switch (Index(12)) {
      case 0:
        Name("blank"), line.insert(place, " ");
        break;
      case 1:
        Name("tab in front"), line.insert(0, "\t");
        break;
      case 2:
        Name("blanks behind"), line += "   ";
        break;
      case 3:
        Name("lower case"), std::transform(line.begin(), line.end(), line.begin(), Lower);
        break;
      case 4:
        Name("remark behind"), line += " ; checked";
        break;
      case 5:
        Name("remark in brackets"), line += " (checked)";
        break;
      case 6:
        Name("remarked out"), line.insert(0, ";");
        break;
      case 7:
        Name("block skip"), line.insert(0, "/");
        break;
      case 8:
        Name("CRLF"), end_ = "\r\n", line += " ";
        break;
      case 9:
        Name("block number"), line.insert(0, "N100 ");
        break;
      case 10:
        if (at_ + 1 >= lines.size()) return;
        Name("lines joined"), line += " " + lines[at_ + 1];
        lines.erase(lines.begin() + static_cast<long>(at_) + 1);
        break;
      default: {
        Name("line split");
        const std::string rest = line.substr(place);
        line.erase(place);
        lines.insert(lines.begin() + static_cast<long>(at_) + 1, rest);
      }
    }
  }

  static char Lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }
  void Name(const std::string& kind) { mutant_.kind = (code_ ? "code: " : "") + kind; }

  RandomStream& random_;
  const Files& other_;
  const Vocabulary& vocabulary_;
  std::string end_ = "\n";
  Mutant mutant_;
  Lines lines_;
  size_t at_ = 0;
  bool code_ = false;  // the number is a G or M code's: another makes another statement of it
};

}  // namespace

bool Mutant::MustPass() const {
  static const std::set<std::string> looks = {
      "digit changed", "digit dropped",    "digit doubled", "sign", "blank",        "tab in front",
      "blanks behind", "lower case",       "remark behind", "CRLF", "block number", "insert ",
      "insert    ",    "insert ; a remark"};
  // A frame that is stated again says the same, also where another follows before any motion.
  for (const char* word : {"$BASE", "$TOOL", "$P_UIFR", "G10", "set_tcp", "set_payload", "set_standard",
                           "SPINDLE_OFF(", "mp_wobj:=", "mp_tool:=", "LOCAL PERS"})
    if (before.starts_with(word)) return false;
  // What must have one value is held to it also where it is stated again before any motion.
  for (const char* word : {"VelSet", "AccSet", "GripLoad", "ActUnit"})
    if (before.starts_with(word)) return false;
  // Data that readers hold to one form, though no trace tells them apart: a zone has one size for tip,
  // orientation and axes; registers, frames and the frames of positions are the cell's; joint speeds do not
  // exceed it; attributes are written in capitals, and nobody documents that others load.
  for (const char* word : {"zonedata mp_", "UTOOL", "UFRAME", "PR[", "UF :", "#VEL_PTP"})
    if (before.find(word) != std::string::npos) return false;
  if (kind == "lower case" && (before.ends_with(",") || before.ends_with(";")) &&
      before.find(" = ") != std::string::npos)
    return false;
  // 9E9 says that there is no such axis; no number near it does.
  if (before.find("9E9") != std::string::npos && after.find("8.99999") != std::string::npos) return false;
  // The check of the controller's frame is read as one text.
  for (const char* word : {"MP_", "LOOP", "HALT", "ENDLOOP", "ENDIF"})
    if (before.find(word) != std::string::npos) return false;
  return looks.contains(kind) || kind.starts_with("number +-");
}

Mutant Mutate(const Files& files, const Files& other, const std::string& controller, RandomStream& random) {
  return Mutator(files, other, controller, random).Make();
}

}  // namespace millpose::campaign
