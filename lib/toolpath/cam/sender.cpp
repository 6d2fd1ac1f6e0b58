// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/sender.hpp"

#include <algorithm>

namespace millpose {
namespace {

using Three = ThreeNumbers;

// One row per sender. Where the rows differ and the sender is not known, the reader asks for the sender.
//  - Three numbers. NX writes i, j, k where they change (CLSF). CATIA locks the axis of the last 5-axis
//  position
//    behind MULTAX/OFF (NC Manufacturing, "MULTAX influence on APT output"). Creo writes i, j, k at every
//    point under MULTAX/ON and none without (NC, CL data in the machine coordinate system); Autodesk's ISO
//    4343 post writes six numbers in tilted operations and three in those along z (writeGOTO).
//  - Cycle by places: depth, feed, clearance from the hole's top (APT, CATIA's PP tables). Autodesk's post
//  hands
//    on the kernel's z of the hole, its bottom, and the clearance as a height (onCycle, onCyclePoint).
//  - P of arcs: LinuxCNC; SINUMERIK has TURN=. G58, G59: programmable shifts on SINUMERIK, zero offsets
//  elsewhere.
//  - Zero offset at power-on: G54 (Fanuc, LinuxCNC), G500 (SINUMERIK).
constexpr SenderRules kRules[] = {
    {CamSender::kPlain, "", "not recognised", true, true, Three::kAsked, true, true, false, "G54"},
    {CamSender::kNx, "nx", "NX", true, false, Three::kKeep},
    {CamSender::kCatia, "catia", "CATIA", true, false, Three::kKeep},
    {CamSender::kCreo, "creo", "Creo", true, false, Three::kUp},
    {CamSender::kAutodesk, "autodesk", "Autodesk (HSM, Fusion)", true, true, Three::kUp, true, true, false,
     "G54"},
    {CamSender::kSolidWorksCam, "solidworks_cam", "SolidWorks CAM", true, true, Three::kAsked, true, true,
     false, "G54"},
    {CamSender::kMastercam, "mastercam", "Mastercam", true, true, Three::kAsked, true, true, false, "G54"},
    {CamSender::kLinuxCnc, "linuxcnc", "LinuxCNC", false, true, Three::kAsked, false, true, false, "G54"},
    {CamSender::kSinumerik, "sinumerik", "SINUMERIK 840D", false, true, Three::kAsked, false, false, true,
     "G500"},
    {CamSender::kHeidenhain, "", "Heidenhain DIN/ISO", false, true, Three::kAsked, false, false, false, ""},
};

// Marks in upper case; all of a row must be there. Behind "\n" a line begins.
struct Mark {
  CamSender sender;
  bool gcode;
  std::vector<std::string_view> all;
};

const std::vector<Mark>& Marks() {
  using S = CamSender;
  static const std::vector<Mark> marks{
      {S::kCreo, false, {"\n$$->"}},
      {S::kCreo, false, {"CREO PARAMETRIC"}},
      {S::kCreo, false, {"PRO/CLFILE"}},
      {S::kCatia, false, {"\n$$*CATIA"}},
      {S::kCatia, false, {"CATIA APT"}},
      {S::kCatia, false, {"TOOLCHANGEBEGINNING"}},
      {S::kCatia, false, {"\nTLON,GOFWD"}},
      {S::kNx, false, {"\nTOOL PATH/"}},
      {S::kNx, false, {"\nTLDATA/"}},
      {S::kNx, false, {"\nEND-OF-PATH"}},
      {S::kNx, false, {"\nPAINT/"}},
      {S::kAutodesk, false, {"\nMODE/MILL", "\nMULTAX/"}},
      {S::kAutodesk, false, {"\nMOVARC/"}},
      {S::kAutodesk, false, {"AUTODESK"}},
      {S::kAutodesk, false, {"HSMWORKS"}},
      {S::kAutodesk, false, {"FUSION 360"}},
      {S::kSolidWorksCam, false, {"SOLIDWORKS CAM"}},
      {S::kSolidWorksCam, false, {"CAMWORKS"}},
      {S::kMastercam, false, {"MASTERCAM"}},
      {S::kSinumerik, true, {"\nTRAORI"}},
      {S::kSinumerik, true, {" TRAORI"}},
      {S::kSinumerik, true, {"TRAFOOF"}},
      {S::kSinumerik, true, {"CYCLE832"}},
      {S::kSinumerik, true, {"CYCLE800"}},
      {S::kSinumerik, true, {"%_N_"}},
      {S::kSinumerik, true, {"SUPA "}},
      {S::kSinumerik, true, {"ORIWKS"}},
      {S::kSinumerik, true, {"MCALL"}},
      {S::kSinumerik, true, {"$P_UIFR"}},
      {S::kSinumerik, true, {"T=\""}},
      {S::kSinumerik, true, {"G710"}},
      {S::kSinumerik, true, {"DEF REAL"}},
      {S::kLinuxCnc, true, {"LINUXCNC"}},
      {S::kLinuxCnc, true, {"EMC2"}},
      {S::kMastercam, true, {"MASTERCAM"}},
      {S::kAutodesk, true, {"AUTODESK"}},
      {S::kAutodesk, true, {"HSMWORKS"}},
      {S::kAutodesk, true, {"FUSION 360"}},
      {S::kAutodesk, true, {"(USING HIGH FEED G1"}},
      {S::kSolidWorksCam, true, {"SOLIDWORKS CAM"}},
      {S::kSolidWorksCam, true, {"CAMWORKS"}},
  };
  return marks;
}

// The start of the file in upper case; each line behind "\n", without blanks in front and around slashes, and
// without the number of a block.
std::string Head(std::string_view bytes) {
  constexpr size_t kHead = 200'000;
  std::string head = "\n";
  bool begins = true;
  for (char c : bytes.substr(0, kHead)) {
    if (c == '\r') c = '\n';
    if (begins && (c == ' ' || c == '\t')) continue;
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    if (c == '/')
      while (head.back() == ' ') head.pop_back();
    if (c == ' ' && head.back() == '/') continue;
    begins = c == '\n';
    head += c;
  }
  return head;
}

// The control that a program is written for tells more of its words than the CAM system.
bool IsControl(CamSender sender) { return sender == CamSender::kSinumerik || sender == CamSender::kLinuxCnc; }

}  // namespace

const SenderRules& RulesOf(CamSender sender) {
  return *std::ranges::find(kRules, sender, &SenderRules::sender);
}

std::vector<CamSender> StatableSenders() {
  std::vector<CamSender> senders;
  for (const SenderRules& rules : kRules)
    if (!rules.key.empty()) senders.push_back(rules.sender);
  return senders;
}

std::string SenderKeys(bool gcode) {
  std::string keys;
  for (const SenderRules& rules : kRules)
    if (!rules.key.empty() && (gcode ? rules.gcode : rules.apt))
      keys += (keys.empty() ? "" : ", ") + std::string(rules.key);
  return keys;
}

Recognised RecogniseSender(std::string_view bytes, bool gcode) {
  const std::string head = Head(bytes);
  Recognised found;
  for (const Mark& mark : Marks()) {
    if (mark.gcode != gcode || mark.sender == found.sender) continue;
    if (found.sender != CamSender::kPlain && gcode && IsControl(found.sender)) continue;
    if (!std::ranges::all_of(mark.all,
                             [&](std::string_view text) { return head.find(text) != std::string::npos; }))
      continue;
    if (found.sender == CamSender::kPlain && found.conflict.empty())
      found.sender = mark.sender;
    else if (found.conflict.empty())
      found.conflict =
          std::string(RulesOf(found.sender).name) + " and " + std::string(RulesOf(mark.sender).name);
  }
  if (!found.conflict.empty()) found.sender = CamSender::kPlain;
  return found;
}

}  // namespace millpose
