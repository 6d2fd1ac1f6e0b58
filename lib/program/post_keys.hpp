// SPDX-License-Identifier: GPL-3.0-or-later
// The keys that controllers share. A controller's table names those that it can follow, in the order in which
// cells are written.
#pragma once

#include "base/yaml/section.hpp"
#include "program/post_options.hpp"

namespace millpose {

using SharedKey = yaml::Field<PostOptions>;

SharedKey ToolAxisKey();
/// `doc`: whose A, B, C.
SharedKey RotationKey();
SharedKey AxisSignsKey();
SharedKey AxisOffsetsKey();
SharedKey AxisCouplingsKey();
SharedKey PathAccelerationKey();
/// `usual`: s, as the controller is often set up.
SharedKey CycleKey(double usual);
SharedKey BlockTimeKey();
/// Of controllers whose makers do not document the path of a rounded corner.
SharedKey MaxCornerKey();
SharedKey MaxMotionsKey();
SharedKey MaxKbytesKey();
/// `names`: by which the controller can know an axis; empty: any word. `still`: whether programs state those,
/// too, that the cell does not plan.
SharedKey ExternalAxesKey(const std::vector<std::string>& names, bool still);
/// `delay`: whether outputs may be switched later or earlier than at their place.
SharedKey OutputsKey(bool delay);
/// `own`: events beside those that every program has.
SharedKey TextsKey(const std::vector<std::string>& own = {});
SharedKey CallsKey();

/// A name that programs can hold as a word.
bool IsWord(const std::string& name);

}  // namespace millpose
