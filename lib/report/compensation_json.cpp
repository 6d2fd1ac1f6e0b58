// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/compensation_json.hpp"

#include "base/units.hpp"

namespace millpose {

nlohmann::ordered_json CompensationJson(const CompensationFigures& f) {
  using Json = nlohmann::ordered_json;
  constexpr double kMicrometres = 1000;
  Json programs = Json::array();
  for (const CarriedBy& program : f.programs)
    programs.push_back(
        {{"controller", program.controller}, {"carried_within_um", kMicrometres * program.largest}});
  Json json = {{"points", f.points},
               {"left_alone", f.left_alone},
               {"cut_to_max", f.bounded},
               {"largest_shift_um", kMicrometres * f.largest_shift},
               {"largest_weight_um", kMicrometres * f.largest_weight},
               {"largest_map_um", kMicrometres * f.largest_map},
               {"largest_deviation_mm", f.largest_arm_shift},
               {"largest_deviation_deg", RadToDeg(f.largest_arm_turn)},
               {"normal",
                {{"expected_before_um", kMicrometres * f.expected_before},
                 {"expected_after_um", kMicrometres * f.expected_after},
                 {"worst_before_um", kMicrometres * f.worst_before},
                 {"worst_after_um", kMicrometres * f.worst_after},
                 {"median_remaining_share", f.remains ? Json(*f.remains) : Json(nullptr)},
                 {"could_make_worse", f.could_hurt}}},
               {"programs", programs}};
  if (f.largest_gear) json["largest_gear_mm"] = *f.largest_gear;
  return json;
}

}  // namespace millpose
