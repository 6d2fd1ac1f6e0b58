// SPDX-License-Identifier: GPL-3.0-or-later
#include "identify_geometry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/loose_file.hpp"
#include "base/random.hpp"
#include "base/rounded.hpp"
#include "base/units.hpp"
#include "commands.hpp"
#include "job/assemble.hpp"
#include "job/config/measurements.hpp"
#include "job/inputs.hpp"
#include "machine/collision/world.hpp"
#include "machine/identification/geometry_couplings.hpp"

namespace millpose {
namespace {

using Tree = nlohmann::ordered_json;
constexpr double kWithin95 = 1.959963984540054;
constexpr const char* kComponents[] = {"shift x", "shift y", "shift z", "turn x", "turn y", "turn z"};

std::vector<TrackedPose> ReadSet(const std::string& file, size_t set) {
  std::vector<TrackedPose> poses;
  for (const TrackedRow& row : ParseTracked(ReadFile(file), file))
    poses.push_back({row.joints, row.reflectors, set});
  if (poses.empty()) throw InputError({file}, "no readings; allowed: at least one row");
  return poses;
}

/// What a fit makes of readings that it has not seen, the tracker's place fitted to them.
struct Judged {
  std::string file;
  double rms = 0;         ///< mm, of the distance
  double error_95 = 0;    ///< mm, 95 % of a coordinate's errors are smaller
  double covered = 0;     ///< share of coordinates within their 95 % interval
  double half_width = 0;  ///< mm, median of half of that
  size_t readings = 0;
};

double QuantileOf(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

Judged JudgeBy(const GeometryFit& fit, const std::string& file) {
  const std::vector<TrackedPose> poses = ReadSet(file, 0);
  if (poses.front().reflectors.size() != fit.reflectors().size())
    throw InputError({file}, fmt::format("{} reflectors; allowed: {}, as in the readings that were fitted",
                                         poses.front().reflectors.size(), fit.reflectors().size()));
  const Pose X_BT = FitBase(fit, poses).inverse(Eigen::Isometry);
  Judged judged{file};
  std::vector<double> errors, halves;
  size_t inside = 0;
  const std::vector<GeometryFit::Foretold> foretold = fit.PredictSet(poses);
  for (const TrackedPose& pose : poses)
    for (size_t k = 0; k < pose.reflectors.size(); ++k) {
      const GeometryFit::Foretold& at = foretold[judged.readings];
      const Eigen::Vector3d off = X_BT * pose.reflectors[k] - at.position;
      judged.rms += off.squaredNorm();
      ++judged.readings;
      for (int axis = 0; axis < 3; ++axis) {
        errors.push_back(std::abs(off[axis]));
        halves.push_back(kWithin95 * std::sqrt(at.covariance(axis, axis) + fit.level() * fit.level()));
        inside += errors.back() <= halves.back();
      }
    }
  judged.rms = std::sqrt(judged.rms / static_cast<double>(judged.readings));
  judged.covered = static_cast<double>(inside) / static_cast<double>(errors.size());
  judged.error_95 = QuantileOf(errors, 0.95);
  judged.half_width = QuantileOf(halves, 0.5);
  return judged;
}

/// Poses within the limits and free of the cell's bodies whose readings would tell most, one after the other.
std::vector<Joints> Propose(GeometryFit fit, const Cell& cell, int count) {
  constexpr int kCandidates = 400;
  const World world(cell);
  Checker checker(world);
  RandomStream random(1, 0);
  std::vector<Joints> candidates, chosen;
  for (int tried = 0; tried < 20 * kCandidates && candidates.size() < kCandidates; ++tried) {
    Joints q;
    for (int j = 0; j < 6; ++j)
      q[j] = random.Uniform(std::max(cell.arm.lower[j], -kPi), std::min(cell.arm.upper[j], kPi));
    const bool apart = std::ranges::none_of(cell.arm.coupled_limits,
                                            [&](const CoupledLimit& limit) { return limit.Beyond(q) > 0; });
    if (apart && !checker.Blocked(q, Phase::kFree)) candidates.push_back(q);
  }
  for (int i = 0; i < count && !candidates.empty(); ++i) {
    size_t best = 0;
    double most = 0;
    for (size_t k = 0; k < candidates.size(); ++k)
      if (const double gain = fit.Gain(candidates[k]); gain > most) most = gain, best = k;
    fit.Add(candidates[best]);
    chosen.push_back(candidates[best]);
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return chosen;
}

/// In the unit that people read: mm, mrad.
double Readable(size_t component, double value) { return component < 3 ? value : 1e3 * value; }

/// To a hundredth of its standard deviation: what lies below, no reading has said, and on a part where the
/// frame takes up most, the digits of 26 numbers must not add up to what is left.
double Rounded(double value, double deviation) {
  int decimals = 0;
  for (double step = 1; step > 0.01 * deviation && decimals < 9; step /= 10) ++decimals;
  return WithDecimals(value, decimals);
}

/// The 95 % interval of what is left along one direction, mm.
double UncertaintyOf(const GeometryFit& fit) { return kWithin95 * fit.left_out() / std::sqrt(3.0); }

/// To a nm and a nrad: the parts of a pattern cancel each other to a thousandth.
double Written(size_t component, double value) { return WithDecimals(Readable(component, value), 6); }

std::vector<DeviationPattern> PatternsOf(const GeometryFit& fit) {
  std::vector<DeviationPattern> patterns;
  for (const ArmDeviations& pattern : fit.Patterns()) {
    DeviationPattern& one = patterns.emplace_back();
    for (size_t frame = 0; frame < 7; ++frame) {
      const auto rounded = [](size_t component, const Eigen::Vector3d& v) {
        return Eigen::Vector3d(Written(component, v.x()), Written(component, v.y()),
                               Written(component, v.z()));
      };
      one.shifts.push_back(rounded(0, pattern.shift[frame]));
      one.turns.push_back(rounded(3, pattern.turn[frame]) / 1000);
    }
    for (const JointCoupling& pair : pattern.law.couplings)
      one.factors.push_back(WithDecimals(pair.factor, 10));
  }
  return patterns;
}

DeviationSettings DeviationsOf(const GeometryFit& fit, const GeometryWords& words) {
  DeviationSettings found;
  found.shifts.assign(7, Eigen::Vector3d::Zero());
  found.turns.assign(7, Eigen::Vector3d::Zero());
  for (size_t frame = 1; frame < 6; ++frame)
    for (size_t component = 0; component < 6; ++component) {
      const DeviationEstimate one = fit.Estimate(frame, component);
      const double rounded = Rounded(Readable(component, one.value), Readable(component, one.alone));
      const auto axis = static_cast<Eigen::Index>(component % 3);
      (component < 3 ? found.shifts : found.turns)[frame][axis] = component < 3 ? rounded : rounded / 1e3;
    }
  for (size_t k = 0; k < fit.couplings().size(); ++k) {
    const auto [joint, follows] = fit.couplings()[k];
    found.couplings.push_back({joint, follows, Rounded(fit.Coupling(k).value, fit.Coupling(k).alone)});
  }
  found.patterns = PatternsOf(fit);
  found.uncertainty = WithDigits(UncertaintyOf(fit), 2);
  std::vector<std::string> names;
  for (const std::string& file : words.files)
    names.push_back(std::filesystem::path(file).filename().string());
  found.source = fmt::format("millpose identify --geometry {}, {} readings, {:.3g} mm RMS left out",
                             fmt::join(names, " "), fit.readings(), fit.left_out());
  found.date = words.date;
  return found;
}

void WriteCell(const GeometryFit& fit, const ArmSettings& arm, const GeometryWords& words) {
  const std::string serial = words.serial.empty() ? arm.serial : words.serial;
  EditLooseFile(words.write_cell, [&](const std::string& text) {
    return ReplaceDeviations(text, words.write_cell, DeviationsOf(fit, words), serial);
  });
  std::fputs(fmt::format("millpose: {} updated\n", words.write_cell).c_str(), stderr);
}

/// What no arm of this sheet can be: readings of another arm, in another unit, of other joints.
std::vector<std::string> FindingsOf(const GeometryFit& fit) {
  constexpr double kMostLeftOut = 2, kMostPriors = 4;  // mm; an arm's own geometry leaves tenths
  std::vector<std::string> findings;
  if (fit.left_out() > kMostLeftOut)
    findings.push_back(
        fmt::format("readings are foretold by the others to {:.3g} mm RMS; an arm's geometry leaves "
                    "at most {:.3g} mm: another arm, unit, order of joints, count of an angle (they count "
                    "as the cell's arm, not as the controller) or a tracker that moved",
                    fit.left_out(), kMostLeftOut));
  for (size_t frame = 1; frame < 6; ++frame)
    for (size_t component = 0; component < 6; ++component) {
      const DeviationEstimate one = fit.Estimate(frame, component);
      if (std::abs(one.value) <= kMostPriors * one.prior) continue;
      findings.push_back(
          fmt::format("frame {}, {}: {:.4g} {}, more than {} times the sheet's own deviation ({:.4g}): the "
                      "cell's lengths, "
                      "signs or zeros are not this arm's, or the prior is too narrow",
                      frame, kComponents[component], Readable(component, one.value),
                      component < 3 ? "mm" : "mrad", kMostPriors, Readable(component, one.prior)));
    }
  return findings;
}

std::string NameOf(const JointPair& pair) { return fmt::format("A{} with A{}", pair.joint, pair.follows); }

Tree CouplingsJson(const CouplingModels& models) {
  Tree tried = Tree::array();
  for (const CouplingModel& model : models.tried) {
    Tree couplings = Tree::array();
    for (size_t k = 0; k < model.couplings.size(); ++k)
      couplings.push_back({{"joints", NameOf(model.couplings[k])},
                           {"factor", model.estimates[k].value},
                           {"half_width_95", kWithin95 * model.estimates[k].deviation}});
    tried.push_back({{"couplings", couplings},
                     {"left_out_rms_mm", std::sqrt(model.mean_square)},
                     {"left_out_mean_square_mm2", model.mean_square},
                     {"standard_deviation_mm2", model.deviation}});
  }
  return {{"tried", tried}, {"least", models.least}, {"chosen", models.chosen}};
}

void PrintCouplings(const CouplingModels& models) {
  const CouplingModel& chosen = models.tried[models.chosen];
  for (size_t k = 0; k < chosen.couplings.size(); ++k)
    fmt::print("coupling   {} by {:.6f} ±{:.6f}\n", NameOf(chosen.couplings[k]), chosen.estimates[k].value,
               kWithin95 * chosen.estimates[k].deviation);
  if (!chosen.couplings.empty())
    fmt::print("poses are foretold to {:.4g} mm RMS with couplings, to {:.4g} without\n",
               std::sqrt(chosen.mean_square), std::sqrt(models.tried[0].mean_square));
}

Tree ToJson(const GeometryFit& nominal, const GeometryFit& fit, const CouplingModels& couplings,
            const std::vector<std::string>& findings, const std::vector<Judged>& judged,
            const std::vector<Joints>& proposed, const GeometryWords& words) {
  Tree deviations = Tree::array(), sets = Tree::array(), foretold = Tree::array(), poses = Tree::array();
  for (size_t frame = 1; frame < 6; ++frame)
    for (size_t component = 0; component < 6; ++component) {
      const DeviationEstimate one = fit.Estimate(frame, component);
      deviations.push_back({{"frame", frame},
                            {"component", kComponents[component]},
                            {"unit", component < 3 ? "mm" : "mrad"},
                            {"told", one.told()},
                            {"value", Readable(component, one.value)},
                            {"half_width_95", Readable(component, kWithin95 * one.deviation)}});
    }
  for (size_t set = 0; set < words.files.size(); ++set)
    sets.push_back(
        {{"file", words.files[set]}, {"rms_mm", fit.RmsOf(set)}, {"nominal_rms_mm", nominal.RmsOf(set)}});
  for (const Judged& one : judged)
    foretold.push_back({{"file", one.file},
                        {"readings", one.readings},
                        {"rms_mm", one.rms},
                        {"error_95_mm", one.error_95},
                        {"covered", one.covered},
                        {"median_half_width_mm", one.half_width}});
  for (const Joints& q : proposed) {
    Tree pose = Tree::array();
    for (const double angle : q) pose.push_back(RadToDeg(angle));
    poses.push_back(pose);
  }
  return {{"schema_version", 1},
          {"readings", fit.readings()},
          {"nominal_rms_mm", nominal.rms()},
          {"rms_mm", fit.rms()},
          {"left_out_rms_mm", fit.left_out()},
          {"coordinate_deviation_mm", fit.level()},
          {"determined_unknowns", fit.effective()},
          {"condition", fit.condition()},
          {"deviations", deviations},
          {"couplings", CouplingsJson(couplings)},
          {"sets", sets},
          {"foretold", foretold},
          {"proposed_deg", poses},
          {"findings", findings}};
}

void Print(const GeometryFit& nominal, const GeometryFit& fit, const std::vector<Judged>& judged,
           const std::vector<Joints>& proposed, const GeometryWords& words) {
  fmt::print(
      "{} readings; distance left, mm RMS: {:.4g} by the nominal arm, {:.4g} fitted, {:.4g} left out\n",
      fit.readings(), nominal.rms(), fit.rms(), fit.left_out());
  for (size_t set = 0; words.files.size() > 1 && set < words.files.size(); ++set)
    fmt::print("  {}: {:.4g} mm\n", words.files[set], fit.RmsOf(set));
  fmt::print(
      "a coordinate is known to {:.3g} mm; the readings determine {:.1f} unknowns; condition number "
      "{:.3g}\n\n",
      fit.level(), fit.effective(), fit.condition());
  fmt::print("frame   shift x, y, z, mm (95 %)                        turn x, y, z, mrad (95 %)\n");
  for (size_t frame = 1; frame < 6; ++frame) {
    std::string row = fmt::format("{:<5}", frame);
    for (size_t component = 0; component < 6; ++component) {
      const DeviationEstimate one = fit.Estimate(frame, component);
      row += one.told() ? fmt::format("{:>9.3f} ±{:<6.3f}", Readable(component, one.value),
                                      Readable(component, kWithin95 * one.deviation))
                        : fmt::format("{:>9} {:<7}", "not told", "");
    }
    fmt::print("{}\n", row);
  }
  fmt::print(
      "\nnot told: other frames, the base or the reflector do the same there; what the sheet says (0) "
      "holds\n");
  for (const Judged& one : judged)
    fmt::print(
        "foretold   {}: {:.4g} mm RMS over {} readings; {:.1f} % of coordinates within their 95 % interval, "
        "median ±{:.3g} mm; 95 % of errors below {:.3g} mm\n",
        one.file, one.rms, one.readings, 100 * one.covered, one.half_width, one.error_95);
  for (size_t i = 0; i < proposed.size(); ++i)
    fmt::print("next pose {:<3} {:.1f}\n", i + 1, fmt::join(Joints(kDegPerRad * proposed[i]), ", "));
}

}  // namespace

int IdentifyGeometry(const GeometryWords& words) {
  std::map<std::string, std::string> meshes;
  if (words.cell.empty()) throw InputError(SourceLocation{}, "--cell: missing; needed with --geometry");
  if (words.propose == 0)
    throw InputError(SourceLocation{}, "--propose: given 0; allowed with --geometry: 1 to 1000");
  const CellSettings cell = LoadCell(words.cell, &meshes);
  if (!words.write_cell.empty()) {
    std::error_code missing;  // is no other cell's name
    if (!std::filesystem::equivalent(words.cell, words.write_cell, missing))
      throw InputError({words.write_cell},
                       fmt::format("--write-cell: another cell than the one read, {}", words.cell));
    if (words.serial.empty() && cell.arm.serial.empty())
      throw InputError(SourceLocation{},
                       "--serial: missing; needed with --write-cell: whose geometry this is");
    if (words.date.empty())
      throw InputError(SourceLocation{},
                       "--date: missing; needed with --write-cell: the day of the readings, year-month-day");
  }
  const Arm arm = MakeArm(cell.arm);
  GeometryFitOptions options;
  if (cell.arm.deviations && (words.serial.empty() || words.serial == cell.arm.serial))
    options.law = MakeDeviations(*cell.arm.deviations).law;
  options.shift_prior = words.shift_prior;
  options.turn_prior = 1e-3 * words.turn_prior;
  if (words.weight) {
    const std::optional<GravityModel> model = MakeGravity(cell);
    if (!model)
      throw InputError({words.cell},
                       "--weight: the cell has no stiffness.gravity, which says what weighs how much");
    options.sag = [model = *model, arm](const Joints& q, const Eigen::Vector3d& p_F) -> Eigen::Vector3d {
      const Joints torques = GravityTorques(arm, q, model.masses, model.counterbalance, model.gravity);
      return Jacobian(arm, q, p_F).topRows<3>() * torques.cwiseQuotient(arm.stiffness);
    };
  }
  std::vector<TrackedPose> poses;
  for (size_t set = 0; set < words.files.size(); ++set) {
    const std::vector<TrackedPose> read = ReadSet(words.files[set], set);
    if (!poses.empty() && read.front().reflectors.size() != poses.front().reflectors.size())
      throw InputError({words.files[set]}, "another number of reflectors than in the first file");
    poses.insert(poses.end(), read.begin(), read.end());
  }
  GeometryFitOptions plain = options;
  plain.deviations = false;
  const GeometryFit nominal(arm, poses, plain);
  const CouplingModels couplings = TryCouplings(arm, poses, options, GeometryFit(arm, poses, options));
  options.couplings = couplings.tried[couplings.chosen].couplings;
  const GeometryFit fit(arm, poses, options);
  std::vector<Judged> judged;
  for (const std::string& file : words.foretell) judged.push_back(JudgeBy(fit, file));
  std::vector<Joints> proposed;
  if (words.propose > 0) proposed = Propose(fit, MakeCell(cell, meshes), words.propose);
  const std::vector<std::string> findings = FindingsOf(fit);
  if (!words.write_cell.empty() && findings.empty()) WriteCell(fit, cell.arm, words);
  if (words.json)
    fmt::print("{}\n", ToJson(nominal, fit, couplings, findings, judged, proposed, words).dump(2));
  else
    Print(nominal, fit, judged, proposed, words);
  if (!words.json) PrintCouplings(couplings);
  if (!words.json)
    for (const std::string& finding : findings) fmt::print("finding    {}\n", finding);
  if (!words.write_cell.empty() && !findings.empty())
    fmt::print(stderr, "millpose: {} is unchanged: the readings are not plausible\n", words.write_cell);
  return findings.empty() ? kDone : kFindings;
}

}  // namespace millpose
