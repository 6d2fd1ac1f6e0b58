// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/mutations.hpp"

#include <fmt/format.h>

#include <cctype>

#include "tests/campaign/runner.hpp"

namespace millpose::campaign {
namespace {

using Lines = std::vector<std::string>;

/// Statements of each controller that people put into programs, or that a damaged memory of the manual does.
const std::map<std::string, std::vector<std::string>>& Statements() {
  static const std::map<std::string, std::vector<std::string>> statements = {
      {"krl",
       {"HALT",
        "WAIT SEC 0.5",
        "WAIT SEC 0",
        "WAIT FOR $IN[1]",
        "WAIT FOR TRUE",
        "$ADVANCE = 0",
        "$ADVANCE = 1",
        "$ADVANCE = 3",
        "$APO.CDIS = 0",
        "$APO.CDIS = -1",
        "$APO.CDIS = 5",
        "$APO.CVEL = 50",
        "$APO.CPTP = 100",
        "BAS (#INITMOV,0 )",
        "BAS (#VEL_PTP,100 )",
        "BAS (#VEL_PTP,10 )",
        "BAS (#VEL_CP,0.5 )",
        "BAS (#ACC_CP,5 )",
        "BAS (#TOOL,2 )",
        "BAS (#BASE,1 )",
        "$VEL.CP = 0.1",
        "$VEL.CP = 0.0001",
        "$VEL.ORI1 = 1",
        "$VEL.ORI2 = 0.001",
        "$ACC.CP = 0.01",
        "$ACC.ORI1 = 1",
        "$ORI_TYPE = #CONSTANT",
        "$ORI_TYPE = #VAR",
        "$BASE = $NULLFRAME",
        "$TOOL = $NULLFRAME",
        "$BASE = {FRAME: X 0.0,Y 0.0,Z 0.0,A 0.0,B 0.0,C 0.0}",
        "$OUT[5] = TRUE",
        "$OUT[1]=FALSE",
        "TRIGGER WHEN DISTANCE=0 DELAY=0 DO $OUT[5]=TRUE",
        "TRIGGER WHEN DISTANCE=1 DELAY=0 DO $OUT[2]=FALSE",
        "GOTO PASS_0_0",
        "PASS_0_0:",
        "MY_LABEL:",
        "RETURN",
        "END",
        "LIN_REL {X 1}",
        "PTP_REL {A1 5}",
        "LIN {X 1}",
        "PTP {A1 5}",
        "SPLINE",
        "ENDSPLINE",
        "INTERRUPT OFF 3",
        "INTERRUPT ON 3",
        "DECL INT I",
        ";FOLD CHECKED",
        "; a remark",
        "",
        "   ",
        "N10",
        "$OV_PRO = 50",
        "$VEL_AXIS[1] = 100",
        "$CIRC_TYPE = #BASE",
        "$IPO_MODE = #TCP",
        "LOOP",
        "CONTINUE",
        "PULSE ($OUT[1],TRUE,0.5)",
        "FOO ( )",
        "%",
        "&ACCESS RVP",
        "$ACT_TOOL = 1",
        "$LOAD.M = 100.0",
        "(a remark)",
        "/",
        ";ENDFOLD (PASS 9 PIECE 0)",
        ";FOLD PASS 9 PIECE 0"}},
      {"sinumerik",
       {"D0",
        "D2",
        "D1",
        "T=\"OTHER\"",
        "T0",
        "M6",
        "M0",
        "M1",
        "M5",
        "M3",
        "M8",
        "M00",
        "G4 F0.5",
        "G4 F0",
        "TRAFOOF",
        "TRAORI",
        "STOPRE",
        "G54",
        "G55",
        "G500",
        "G53",
        "SUPA",
        "G505",
        "$P_UIFR[1]=CTRANS(X,0,Y,0,Z,0):CROT(X,0,Y,0,Z,0)",
        "G91",
        "G90",
        "G70",
        "G700",
        "G71",
        "G710",
        "G60",
        "G64",
        "G641",
        "G642",
        "G9",
        "G601",
        "G41",
        "G40",
        "G18",
        "G17",
        "G93",
        "G94",
        "G95",
        "F1000",
        "F10",
        "S100",
        "S7000",
        "ORIMKS",
        "ORIWKS",
        "ORIAXES",
        "ORIVECT",
        "ORIEULER",
        "CYCLE832(0,_OFF,1)",
        "CYCLE832(1,_ROUGH,1)",
        "CYCLE832(0.5,_FINISH,0.5)",
        "PTP",
        "CP",
        "G0",
        "G1",
        "MSG(\"checked\")",
        "MSG()",
        "; a remark",
        "",
        "   ",
        "N10",
        "/",
        "GOTOF PASS_0_0",
        "PASS_0_0:",
        "MY_LABEL:",
        "RET",
        "M30",
        "M17",
        "M2",
        "TRANS X1",
        "ROT Z1",
        "WHEN TRUE DO $A_OUT[5]=1",
        "$A_OUT[5]=1",
        "FFWON",
        "SOFT",
        "COMPCAD",
        "G4 S1",
        "R1=5",
        "FOO",
        "%",
        "X1",
        "G1 X1",
        "G0 RA1=5",
        "RA1=5",
        "OTOL=1",
        "CTOL=1",
        "G1 G0",
        "G17 G18",
        "(a remark)",
        "DYNNORM",
        "MSG(\"PASS 9 PIECE 0\")"}},
      {"linuxcnc",
       {"M0",
        "M1",
        "M2",
        "M3",
        "M5",
        "M6",
        "M7",
        "M9",
        "M30",
        "M48",
        "M49",
        "M62 P2",
        "M63 P2",
        "M64 P2",
        "M66 P0 L3 Q1",
        "M68 E3 Q1",
        "M68 E3 Q0",
        "G4 P0.5",
        "G4 P0",
        "G0",
        "G1",
        "G17",
        "G18",
        "G20",
        "G21",
        "G28",
        "G40",
        "G41 D1",
        "G43 H1",
        "G49",
        "G53",
        "G54",
        "G59.3",
        "G61",
        "G61.1",
        "G64",
        "G64 P1",
        "G64 P0.01 Q0.5",
        "G64 P0.0001 Q0",
        "G80",
        "G90",
        "G91",
        "G92 X0",
        "G92.1",
        "G93",
        "G94",
        "G95",
        "G10 L2 P9 X1",
        "G10 L2 P1 X1",
        "F1000",
        "F1",
        "S100",
        "S7000",
        "T1",
        "; a remark",
        "(a remark)",
        "(a) M5 (b)",
        "(a) G20 (b)",
        "(a) G1 X1 (b)",
        "(MSG,hello)",
        "",
        "   ",
        "N10",
        "/",
        "%",
        "#1=5",
        "X1",
        "G1 X1",
        "G0 X1",
        "G2 X1 I1",
        "o100 sub",
        "G21 G21",
        "G0 G1",
        "M62",
        "(a (b))",
        "; PASS 9 PIECE 0",
        "G1 F100"}}};
  return statements;
}

class Mutator {
 public:
  Mutator(const Files& files, const std::string& controller, RandomStream& random)
      : random_(random), controller_(controller) {
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
      Change(changed);
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
    Looks(lines);
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
    const std::vector<std::string>& statements = Statements().at(controller_);
    const std::string& statement = statements[Index(statements.size())];
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
        Name("line copied"), lines.insert(line, lines_[other]);
        break;
      default:
        Name("line replaced"), *line = lines_[other];
        break;
    }
  }

  /// A word of the line changed, dropped, doubled, taken from another line.
  void Words(std::string& line) {
    static const std::vector<std::pair<std::string, std::string>> changes = {
        {"LIN", "PTP"},       {"PTP", "LIN"},     {" C_DIS", ""},
        {"C_DIS", "C_VEL"},   {"C_DIS", "C_PTP"}, {"C_DIS", "C_ORI"},
        {"TRUE", "FALSE"},    {"G1", "G0"},       {"G0", "G1"},
        {"G9 ", ""},          {"G1 ", "G9 G1 "},  {"PTP", "CP"},
        {" CP", ""},          {" CP", " PTP"},    {"G64", "G61"},
        {"G61.1", "G64"},     {"G61.1", "G61"},   {"G93", "G94"},
        {"G94", "G93"},       {"M62", "M63"},     {"M62", "M64"},
        {"X", "Y"},           {"A", "B"},         {"M3", "M4"},
        {"VEL.CP", "ACC.CP"}, {"ORI1", "ORI2"},   {"TRAORI", "TRAFOOF"},
        {"FRAME", "POS"},     {",S ", ",T "},     {"STAT", "TU"},
        {"Q0", "Q1"},         {"P", "Q"}};
    const size_t space = line.find_first_of(" ,", Index(std::max<size_t>(1, line.size())));
    switch (Index(5)) {
      case 0:
      case 1: {
        const auto& [from, to] = changes[Index(changes.size())];
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
  void Looks(Lines& lines) {
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
  void Name(const std::string& kind) { mutant_.kind = kind; }

  RandomStream& random_;
  std::string controller_, end_ = "\n";
  Mutant mutant_;
  Lines lines_;
  size_t at_ = 0;
};

}  // namespace

bool Mutant::MustPass() const {
  static const std::set<std::string> looks = {
      "digit changed", "digit dropped",    "digit doubled", "sign", "blank",        "tab in front",
      "blanks behind", "lower case",       "remark behind", "CRLF", "block number", "insert ",
      "insert    ",    "insert ; a remark"};
  return looks.contains(kind) || kind.starts_with("number +-");
}

Mutant Mutate(const Files& files, const std::string& controller, RandomStream& random) {
  return Mutator(files, controller, random).Make();
}

}  // namespace millpose::campaign
