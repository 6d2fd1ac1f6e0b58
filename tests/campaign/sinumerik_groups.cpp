// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/sinumerik_groups.hpp"

namespace millpose::campaign {

const std::map<std::string, int>& SinumerikGroups() {
  static const std::map<std::string, int> groups = {
      {"G0", 1},        {"G1", 1},       {"G2", 1},       {"G3", 1},        {"G33", 1},      {"G4", 2},
      {"G63", 2},       {"G74", 2},      {"G75", 2},      {"G17", 6},       {"G18", 6},      {"G19", 6},
      {"G40", 7},       {"G41", 7},      {"G42", 7},      {"G500", 8},      {"G54", 8},      {"G55", 8},
      {"G56", 8},       {"G57", 8},      {"G53", 9},      {"SUPA", 9},      {"G153", 9},     {"G60", 10},
      {"G64", 10},      {"G641", 10},    {"G642", 10},    {"G643", 10},     {"G644", 10},    {"G645", 10},
      {"G9", 11},       {"G601", 12},    {"G602", 12},    {"G603", 12},     {"G70", 13},     {"G71", 13},
      {"G700", 13},     {"G710", 13},    {"G90", 14},     {"G91", 14},      {"G93", 15},     {"G94", 15},
      {"G95", 15},      {"G96", 15},     {"G97", 15},     {"BRISK", 21},    {"SOFT", 21},    {"FFWON", 24},
      {"FFWOF", 24},    {"ORIWKS", 25},  {"ORIMKS", 25},  {"COMPOF", 30},   {"COMPCAD", 30}, {"COMPSURF", 30},
      {"PTP", 49},      {"CP", 49},      {"PTPG0", 49},   {"ORIEULER", 50}, {"ORIRPY", 50},  {"ORIRPY2", 50},
      {"ORIVIRT1", 50}, {"ORIVECT", 51}, {"ORIAXES", 51}, {"ORIPATH", 51},  {"ORISOF", 52},  {"DYNNORM", 59},
      {"DYNFINISH", 59}};
  return groups;
}

}  // namespace millpose::campaign
