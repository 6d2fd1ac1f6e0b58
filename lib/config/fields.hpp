// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "config/batch_settings.hpp"
#include "config/codec.hpp"
#include "config/settings.hpp"

namespace millpose::config {

/// The field tables of the files.
const Codec<JobSettings>& JobFields();
const Codec<CellSettings>& CellFields();
const Codec<BatchSettings>& BatchFields();

/// What of a part is milled.
Codec<RegionSettings> RegionFields();

/// What each controller's programs need to know; keys that a controller cannot follow are errors.
Codec<std::map<std::string, ControllerSettings>> ControllersFields();

/// Parts that both tables use.
Codec<PoseSettings> PoseFields();
const std::vector<std::string>& LengthUnits();
/// mm per unit of that name.
double LengthUnit(const std::string& name);
/// Name of the unit of that many mm; "mm" for none.
std::string LengthUnitName(double mm);

}  // namespace millpose::config
