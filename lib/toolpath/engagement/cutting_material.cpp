// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/cutting_material.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "base/error.hpp"

namespace millpose {
namespace {

/// Composites: makers' tables leave their group without a value, and published tests differ by laminate,
/// angle of the fibres and tool. Known, so that the message can say so.
constexpr std::array<std::string_view, 8> kWithoutValue = {"cfrp", "gfrp", "cfk", "gfk",
                                                           "cfc",  "afrp", "frp", "glare"};

/// One line of the user guide's table.
struct Group {
  int number;
  double kc11, mc;
  const char* text;
};

CuttingMaterial Of(const Group& group, const char* name) {
  return {name, group.kc11, group.mc, fmt::format("ISCAR 2022, group {}: {}", group.number, group.text)};
}

// ISCAR, Boring Systems catalogue 2022, user guide "Material Groups" (ISO 513, VDI 3323): kc1 and mc by
// material group. docs/process-force.md compares them with others.
const Group kSteel1{1, 1350, 0.21, "unalloyed steel with less than 0.25 % C, annealed"};
const Group kSteel2{2, 1500, 0.22, "unalloyed steel with 0.25 % C or more, annealed"};
const Group kSteel6{6, 1775, 0.24, "low-alloy steel, annealed"};
const Group kSteel8{8, 1725, 0.24, "low-alloy steel, quenched and tempered, 1000 N/mm²"};
const Group kSteel10{10, 2450, 0.23, "high-alloy and tool steel, annealed"};
const Group kStainless12{12, 1875, 0.21, "stainless steel, ferritic or martensitic"};
const Group kStainless13{13, 1875, 0.21, "stainless steel, martensitic"};
const Group kStainless14{14, 2150, 0.20, "stainless steel, austenitic"};
const Group kDuplex14{14, 2150, 0.20, "stainless steel, duplex"};
const Group kGrey15{15, 1150, 0.20, "grey cast iron, ferritic to pearlitic"};
const Group kGrey16{16, 1350, 0.28, "grey cast iron, pearlitic"};
const Group kNodular17{17, 1225, 0.25, "nodular cast iron, ferritic"};
const Group kNodular18{18, 1350, 0.28, "nodular cast iron, pearlitic"};
const Group kAluminium21{21, 700, 0.25, "wrought aluminium, not hardenable"};
const Group kAluminium22{22, 800, 0.25, "wrought aluminium, hardened"};
const Group kCast23{23, 700, 0.25, "cast aluminium, 12 % Si or less, not hardenable"};
const Group kCast24{24, 700, 0.25, "cast aluminium, 12 % Si or less, hardened"};
const Group kCast25{25, 750, 0.25, "cast aluminium, more than 12 % Si"};
const Group kCopper26{26, 700, 0.27, "copper alloys with more than 1 % Pb, free cutting"};
const Group kCopper27{27, 700, 0.27, "brass"};
const Group kCopper28{28, 700, 0.27, "electrolytic copper"};
const Group kIron32{32, 3100, 0.24, "high-temperature alloy, Fe based, hardened"};
const Group kNickel33{33, 3300, 0.24, "high-temperature alloy, Ni or Co based, annealed"};
const Group kNickel34{34, 3300, 0.24, "Ni or Co based, hardened"};
const Group kTitanium36{36, 1160, 0.24, "titanium, pure"};
const Group kTitanium37{37, 1245, 0.24, "titanium alpha+beta alloys, hardened"};

}  // namespace

const std::vector<CuttingMaterial>& CuttingMaterials() {
  static const std::vector<CuttingMaterial> materials{
      Of(kAluminium21, "5A06"),
      Of(kAluminium21, "AlMg"),
      Of(kAluminium22, "AlZnMgCu"),
      Of(kTitanium37, "TiAl6V4"),
      Of(kNickel34, "Inconel718"),
      Of(kStainless14, "X5CrNi18-10"),
      Of(kSteel2, "C45"),
      Of(kAluminium21, "Al99.5"),
      Of(kAluminium22, "AlMgSi"),
      Of(kAluminium22, "AlCuMg"),
      Of(kCast23, "AlSi12"),
      Of(kCast24, "AlSi7Mg"),
      Of(kCast24, "AlSi10Mg"),
      Of(kCast25, "AlSi17Cu4Mg"),
      Of(kTitanium36, "Ti-Grade2"),
      Of(kNickel33, "Inconel625"),
      Of(kIron32, "A286"),
      Of(kStainless14, "X2CrNi18-9"),
      Of(kStainless14, "X6CrNiTi18-10"),
      Of(kStainless14, "X5CrNiMo17-12-2"),
      Of(kStainless14, "X2CrNiMo17-12-2"),
      Of(kStainless14, "X6CrNiMoTi17-12-2"),
      Of(kDuplex14, "X2CrNiMoN22-5-3"),
      Of(kStainless12, "X6Cr17"),
      Of(kStainless13, "X20Cr13"),
      Of(kSteel1, "S235JR"),
      Of(kSteel1, "C15"),
      Of(kSteel6, "16MnCr5"),
      Of(kSteel8, "42CrMo4+QT"),
      Of(kSteel8, "34CrNiMo6+QT"),
      Of(kSteel10, "X40CrMoV5-1"),
      Of(kSteel10, "X153CrMoV12"),
      Of(kGrey15, "EN-GJL-150"),
      Of(kGrey16, "EN-GJL-250"),
      Of(kNodular17, "EN-GJS-400-15"),
      Of(kNodular18, "EN-GJS-600-3"),
      Of(kCopper28, "Cu-ETP"),
      Of(kCopper27, "CuZn37"),
      Of(kCopper26, "CuZn39Pb3"),
  };
  return materials;
}

const std::vector<MaterialAlias>& MaterialAliases() {
  static const std::vector<MaterialAlias> aliases{
      {"AlMg6", "5A06"},
      {"5052", "AlMg"},
      {"5083", "AlMg"},
      {"5754", "AlMg"},
      {"AlMg3", "AlMg"},
      {"AlMg4.5Mn", "AlMg"},
      {"7050", "AlZnMgCu"},
      {"7075", "AlZnMgCu"},
      {"7075-T6", "AlZnMgCu"},
      {"7075-T651", "AlZnMgCu"},
      {"AlZn5.5MgCu", "AlZnMgCu"},
      {"AlZnMgCu1.5", "AlZnMgCu"},
      {"3.4365", "AlZnMgCu"},
      {"1050", "Al99.5"},
      {"1050A", "Al99.5"},
      {"6060", "AlMgSi"},
      {"6061", "AlMgSi"},
      {"6061-T6", "AlMgSi"},
      {"6063", "AlMgSi"},
      {"6082", "AlMgSi"},
      {"6082-T6", "AlMgSi"},
      {"AlMgSi1", "AlMgSi"},
      {"AlMg1SiCu", "AlMgSi"},
      {"3.2315", "AlMgSi"},
      {"2014", "AlCuMg"},
      {"2017", "AlCuMg"},
      {"2024", "AlCuMg"},
      {"2024-T3", "AlCuMg"},
      {"2024-T351", "AlCuMg"},
      {"2A12", "AlCuMg"},
      {"AlCu4Mg1", "AlCuMg"},
      {"A413", "AlSi12"},
      {"44200", "AlSi12"},
      {"A356", "AlSi7Mg"},
      {"42100", "AlSi7Mg"},
      {"43000", "AlSi10Mg"},
      {"A390", "AlSi17Cu4Mg"},
      {"Grade2", "Ti-Grade2"},
      {"Ti-Gr2", "Ti-Grade2"},
      {"3.7035", "Ti-Grade2"},
      {"Ti-6Al-4V", "TiAl6V4"},
      {"Ti-Grade5", "TiAl6V4"},
      {"Ti-Gr5", "TiAl6V4"},
      {"Grade5", "TiAl6V4"},
      {"TC4", "TiAl6V4"},
      {"3.7165", "TiAl6V4"},
      {"Alloy718", "Inconel718"},
      {"GH4169", "Inconel718"},
      {"2.4668", "Inconel718"},
      {"Alloy625", "Inconel625"},
      {"2.4856", "Inconel625"},
      {"1.4980", "A286"},
      {"304", "X5CrNi18-10"},
      {"1.4301", "X5CrNi18-10"},
      {"304L", "X2CrNi18-9"},
      {"1.4307", "X2CrNi18-9"},
      {"321", "X6CrNiTi18-10"},
      {"1.4541", "X6CrNiTi18-10"},
      {"316", "X5CrNiMo17-12-2"},
      {"1.4401", "X5CrNiMo17-12-2"},
      {"316L", "X2CrNiMo17-12-2"},
      {"1.4404", "X2CrNiMo17-12-2"},
      {"316Ti", "X6CrNiMoTi17-12-2"},
      {"1.4571", "X6CrNiMoTi17-12-2"},
      {"2205", "X2CrNiMoN22-5-3"},
      {"1.4462", "X2CrNiMoN22-5-3"},
      {"430", "X6Cr17"},
      {"1.4016", "X6Cr17"},
      {"420", "X20Cr13"},
      {"1.4021", "X20Cr13"},
      {"S235", "S235JR"},
      {"St37", "S235JR"},
      {"1.0038", "S235JR"},
      {"1015", "C15"},
      {"1.0401", "C15"},
      {"1045", "C45"},
      {"C45E", "C45"},
      {"Ck45", "C45"},
      {"1.0503", "C45"},
      {"1.1191", "C45"},
      {"1.7131", "16MnCr5"},
      {"42CrMo4", "42CrMo4+QT"},
      {"4140", "42CrMo4+QT"},
      {"1.7225", "42CrMo4+QT"},
      {"34CrNiMo6", "34CrNiMo6+QT"},
      {"4340", "34CrNiMo6+QT"},
      {"1.6582", "34CrNiMo6+QT"},
      {"H13", "X40CrMoV5-1"},
      {"1.2344", "X40CrMoV5-1"},
      {"D2", "X153CrMoV12"},
      {"1.2379", "X153CrMoV12"},
      {"GG15", "EN-GJL-150"},
      {"GJL-150", "EN-GJL-150"},
      {"GG25", "EN-GJL-250"},
      {"GJL-250", "EN-GJL-250"},
      {"0.6025", "EN-GJL-250"},
      {"GGG40", "EN-GJS-400-15"},
      {"GJS-400-15", "EN-GJS-400-15"},
      {"0.7040", "EN-GJS-400-15"},
      {"GGG60", "EN-GJS-600-3"},
      {"GJS-600-3", "EN-GJS-600-3"},
      {"0.7060", "EN-GJS-600-3"},
      {"E-Cu58", "Cu-ETP"},
      {"CW004A", "Cu-ETP"},
      {"CW508L", "CuZn37"},
      {"2.0321", "CuZn37"},
      {"Ms58", "CuZn39Pb3"},
      {"CW614N", "CuZn39Pb3"},
      {"2.0401", "CuZn39Pb3"},
  };
  return aliases;
}

std::string MaterialKey(const std::string& name) {
  std::string key;
  for (const char c : name) {
    if (c == ' ' || c == '-' || c == '_') continue;
    key += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  if (key.starts_with("enaw") || key.starts_with("enac")) key.erase(0, 4);
  return key;
}

const CuttingMaterial* FindCuttingMaterial(const std::string& name) {
  const std::string key = MaterialKey(name);
  std::string wanted;
  for (const MaterialAlias& alias : MaterialAliases())
    if (MaterialKey(alias.alias) == key) wanted = alias.name;
  for (const CuttingMaterial& known : CuttingMaterials())
    if (known.name == wanted || MaterialKey(known.name) == key) return &known;
  return nullptr;
}

std::string UnknownMaterial(const std::string& name) {
  if (std::ranges::count(kWithoutValue, MaterialKey(name)) > 0)
    return fmt::format(
        "given {}; composites have no value in the table, as it depends on laminate, fibre angle and tool; "
        "allowed: kc11_N_mm2 and mc of your own laminate and tool (docs/process-force.md)",
        name);
  std::vector<std::string> names, all;
  for (const CuttingMaterial& known : CuttingMaterials()) names.push_back(known.name);
  all = names;
  for (const MaterialAlias& alias : MaterialAliases()) all.push_back(alias.alias);
  const std::string nearest = NearestName(name, all);
  return fmt::format("given {}; allowed: {}, their aliases (docs/process-force.md), or kc11_N_mm2 and mc{}",
                     name, fmt::join(names, ", "), nearest.empty() ? "" : "; nearest: " + nearest);
}

}  // namespace millpose
