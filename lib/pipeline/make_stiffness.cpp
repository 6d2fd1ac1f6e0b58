// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of compliance, weight and cutting force → values of the stiffness module.
#include "base/error.hpp"
#include "pipeline/assemble.hpp"

namespace millpose {
namespace {

/// base → 0, link1..link6 → 1..6: config allows no other.
int LinkOf(const std::string& mount) { return mount == "base" ? 0 : mount.back() - '0'; }

}  // namespace

std::vector<SeriesCompliance> MakeCompliances(const CellSettings& settings) {
  std::vector<SeriesCompliance> elements;
  for (const ComplianceSettings& from : settings.compliances) {
    SeriesCompliance element;
    element.name = from.name;
    element.link = LinkOf(from.mount);
    element.X_LK = MakePose(from.pose);
    element.C.diagonal() << from.translational, from.rotational;
    for (size_t i = 0; i < from.matrix.size(); ++i)
      element.C.row(static_cast<Eigen::Index>(i)) = from.matrix[i];
    elements.push_back(element);
  }
  return elements;
}

std::optional<GravityModel> MakeGravity(const CellSettings& settings) {
  if (!settings.gravity) return std::nullopt;
  GravityModel model;
  model.reference = settings.gravity->reference;
  for (const MassSettings& from : settings.gravity->masses)
    model.masses.push_back({from.name, LinkOf(from.mount), from.mass, from.centre});
  model.counterbalance_given = settings.gravity->counterbalance_torque.has_value();
  model.counterbalance = {settings.gravity->counterbalance_torque.value_or(0.0),
                          settings.gravity->counterbalance_zero};
  constexpr double kGravity = 9810;  // mm/s², along −z of W
  model.gravity = MakePose(settings.base_in_world).linear().transpose() * Eigen::Vector3d(0, 0, -kGravity);
  return model;
}

std::optional<CuttingForce> MakeCuttingForce(const JobSettings& job, const CellSettings& cell) {
  if (!job.cutting) return std::nullopt;
  const CuttingSettings& from = *job.cutting;
  Cut cut;
  cut.material = {from.material, from.kc11, from.mc, "job"};
  if (from.kc11 <= 0) {
    std::vector<std::string> names;
    for (const CuttingMaterial& material : CuttingMaterials()) names.push_back(material.name);
    const auto found = std::find(names.begin(), names.end(), from.material);
    if (found == names.end()) {
      const std::string nearest = NearestName(from.material, names);
      throw InputError(
          {job.file},
          fmt::format("process.cutting.material: given {}; allowed: {}, or kc11_N_mm2 and mc{}",
                      from.material, fmt::join(names, ", "), nearest.empty() ? "" : "; nearest: " + nearest));
    }
    cut.material = CuttingMaterials()[static_cast<size_t>(found - names.begin())];
  }
  if (job.spindle_speed <= 0)
    throw InputError({job.file}, "process.spindle_rpm: given 0; process.cutting needs it above 0");
  cut.diameter = cell.tool.cutter_diameter;
  cut.teeth = from.teeth;
  cut.depth = from.depth;
  cut.width = from.width;
  cut.feed_per_tooth = job.feed / (job.spindle_speed * from.teeth);
  cut.side = from.side == "up"     ? MillingSide::kUp
             : from.side == "down" ? MillingSide::kDown
                                   : MillingSide::kSlot;
  cut.radial_ratio = from.radial_ratio;
  cut.axial_ratio = from.axial_ratio;
  if (cut.side != MillingSide::kSlot && cut.width > cut.diameter)
    throw InputError(
        {job.file},
        fmt::format("process.cutting.width_mm: given {}; allowed: at most the cutter's diameter, {} mm",
                    cut.width, cut.diameter));
  return MeanCuttingForce(cut);
}

}  // namespace millpose
