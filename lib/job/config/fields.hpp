// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/yaml/section.hpp"
#include "job/config/batch_settings.hpp"
#include "job/config/cell_settings.hpp"
#include "job/config/job_settings.hpp"

namespace millpose::config {

using namespace yaml;   // NOLINT: the tables are written in its words
using yaml::Direction;  // not the enum

/// The files.
const Codec<JobSettings>& JobFields();
const Codec<CellSettings>& CellFields();
const Codec<BatchSettings>& BatchFields();
const Codec<ToolsFile>& ToolsFileFields();

/// The sections of a job.
Codec<WorkpieceSettings> WorkpieceFields();
Codec<ToolpathSettings> ToolpathFields();
Codec<JobSettings> ProcessFields();
Codec<JobSettings> PoseSearchFields();
Codec<JobSettings> LimitFields();
Codec<JobSettings> PathFields();
Codec<JobSettings> InterferenceFields();
Codec<JobSettings> LinkMoveFields();
Codec<ProgramOptionSettings> ProgramOptionFields();
Codec<CompensationSettings> CompensationFields();
Codec<PlacementSettings> PlacementFields();
/// One entry of `external`.
Codec<ExternalSettings> ExternalFields();
/// Keys of the process that objectives take as parameters: how sure the cutting force is.
inline const std::array<std::string, 2> kForceBounds{"force_uncertainty_percent", "force_direction_deg"};
/// Whether something of a job follows them: its objective, or compensation.
bool AsksForceBounds(const JobSettings& job);
/// `region` of a toolpath: what of a part is milled.
Codec<RegionOptions> RegionFields();

/// The sections of a cell.
Codec<ArmSettings> ArmFields();
Codec<DeviationSettings> DeviationFields();
/// Deviations are one arm's, and a controller that has them itself must not be given them again.
void CheckDeviations(const Value& value, const Context& context, const ArmSettings& arm);
/// `fields` and those of its gears, and what is wrong with these.
std::vector<Field<ArmSettings>> WithGears(std::vector<Field<ArmSettings>> fields);
void CheckGears(const Value& value, const Context& context, const ArmSettings& arm);
void CheckGearFriction(const Value& value, const Context& context, const CellSettings& cell);
/// A lost motion (`key`) has a source, and a source one.
void CheckLostMotionSource(const Value& value, const Context& context, const char* key,
                           const std::string& source);
extern const Unit kArcmin, kArcsec, kNewtonMetre;
Codec<ToolSettings> ToolFields();
Codec<BodySettings> BodyFields();
Codec<ShapeSettings> ShapeFields();
Codec<CellSettings> StiffnessFields();
/// One entry of `external_axes`, and what is wrong with all of them and with the bodies on them.
Codec<ExternalAxisSettings> ExternalAxisFields();
void CheckExternalAxes(const Value& value, const Context& context, const CellSettings& cell);
/// One compliance in series with the joints.
Codec<ComplianceSettings> ComplianceFields();
/// What each controller's programs need to know, from the tables of lib/program; keys that a controller
/// cannot follow are errors.
Codec<std::map<std::string, ControllerOptions>> ControllersFields();

/// What several tables use.
/// Name of a unit of length; mm per unit in the settings.
Codec<double> LengthUnit();
/// JSON Schema of the name of an operation or a setup.
Value WordSchema();
/// JSON Schema of a list of 1 to `most` maps with these properties, of which `name` is required.
Value NamedMapsSchema(const Value& properties, size_t most);

}  // namespace millpose::config
