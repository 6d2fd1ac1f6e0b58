// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/plausibility.hpp"

#include "machine/identification/identify_system.hpp"

namespace millpose {
namespace {

// Of a set: its largest force, N, and displacement, mm. Loads below 5 N or displacements below 5 µm show
// nothing, above 100 kN or 50 mm the arm is broken.
constexpr double kLeastForce = 5, kMostForce = 1e5, kLeastDisplacement = 0.005, kMostDisplacement = 50;
// Joint stiffness, N·m/rad: of no arm, and of few.
constexpr double kLeastStiffness = 1e2, kMostStiffness = 1e10, kLowStiffness = 1e4, kHighStiffness = 1e9;
constexpr double kFarAbove = 10;  // times the stated deviation
constexpr double kSpread = 100;   // between poses: more than arms differ from pose to pose, less than a unit
constexpr double kShare = 0.05;   // of the largest expected displacement: smaller ones may be noise alone
constexpr double kNmPerNmm = 1e-3;

/// A figure of each pose that has one.
struct OfPose {
  size_t pose;
  double value;
};

/// Poses on the smaller side of the largest gap, when the figures differ by more than units leave room for.
std::vector<size_t> Strangers(std::vector<OfPose> figures) {
  std::ranges::sort(figures, {}, &OfPose::value);
  if (figures.size() < 2 || figures.back().value <= kSpread * figures.front().value) return {};
  size_t gap = 1;
  for (size_t i = 1; i < figures.size(); ++i)
    if (figures[i].value * figures[gap - 1].value > figures[gap].value * figures[i - 1].value) gap = i;
  const bool lower_few = gap <= figures.size() - gap;
  std::vector<size_t> poses;
  for (size_t i = lower_few ? 0 : gap; i < (lower_few ? gap : figures.size()); ++i)
    poses.push_back(figures[i].pose + 1);
  std::ranges::sort(poses);
  return poses;
}

class Judge {
 public:
  Judge(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options,
        const Identification& found)
      : arm_(arm), cases_(cases), options_(options), found_(found) {}

  Plausibility Run() {
    JudgeReadings();
    JudgePoses();
    JudgeStiffness();
    if (!found_.residuals.empty()) JudgeResidual();
    return std::move(result_);
  }

 private:
  void Disbelieve(std::string text) {
    result_.findings.push_back(std::move(text));
    result_.usable = false;
  }

  void JudgeReadings() {
    double force = 0, displacement = 0;
    for (const LoadCase& load : cases_) {
      force = std::max(force, load.force.norm());
      displacement = std::max(displacement, load.displacement.norm());
    }
    if (force > 0 && (force < kLeastForce || force > kMostForce))
      Disbelieve(fmt::format(
          "the largest force is {:.4g} N; an arm is measured with {} to {:.0f} N: is it given in N?", force,
          kLeastForce, kMostForce));
    if (displacement < kLeastDisplacement || displacement > kMostDisplacement)
      Disbelieve(fmt::format(
          "the largest displacement is {:.4g} mm; {} to {} mm are measured on an arm: is it given in "
          "mm?",
          displacement, kLeastDisplacement, kMostDisplacement));
  }

  // Force of each pose, and its displacement against what the arm's own stiffness lets expect.
  void JudgePoses() {
    std::vector<double> force(found_.poses), moved(found_.poses), expected(found_.poses);
    IdentifyOptions plain;
    plain.displacement_deviation = 1;
    const Joints c = arm_.stiffness.cwiseInverse();
    for (size_t i = 0; i < cases_.size(); ++i) {
      LoadCase load = cases_[i];
      load.rotation.reset();
      const identify::System system = identify::MakeSystem(arm_, {load}, plain);
      const size_t pose = found_.pose_of_case[i];
      force[pose] = std::max(force[pose], load.force.norm());
      moved[pose] = std::max(moved[pose], system.x.norm());
      expected[pose] = std::max(expected[pose], (system.L * c).norm());
    }
    std::vector<OfPose> forces, ratios;
    const double largest = *std::ranges::max_element(expected);
    for (size_t pose = 0; pose < found_.poses; ++pose) {
      if (force[pose] > 0) forces.push_back({pose, force[pose]});
      if (moved[pose] > 0 && expected[pose] > 0) ratios.push_back({pose, moved[pose] / expected[pose]});
    }
    std::erase_if(ratios, [&](const OfPose& ratio) {
      return expected[ratio.pose] < kShare * largest &&
             moved[ratio.pose] < kFarAbove * options_.displacement_deviation;
    });
    Tell(Strangers(std::move(forces)), "forces");
    Tell(Strangers(std::move(ratios)), "displacements under their loads");
  }

  void Tell(const std::vector<size_t>& poses, const char* what) {
    if (!poses.empty())
      Disbelieve(fmt::format(
          "{} of pose {} differ from those of the others by a factor of {} or more: are units mixed?", what,
          fmt::join(poses, ", "), kSpread));
  }

  void JudgeStiffness() {
    for (size_t j = 0; j < 6; ++j) {
      const JointEstimate& joint = found_.joints[j];
      if (!joint.determined) continue;
      const double k = joint.stiffness * kNmPerNmm;
      if (k < kLeastStiffness || k > kMostStiffness)
        Disbelieve(fmt::format("A{}: {:.4g} N·m/rad is no joint's stiffness; allowed: {:.0e} to {:.0e}",
                               j + 1, k, kLeastStiffness, kMostStiffness));
      else if (k < kLowStiffness || k > kHighStiffness)
        result_.warnings.push_back(
            fmt::format("A{}: {:.4g} N·m/rad is unusual; joints of milling arms have {:.0e} to "
                        "{:.0e}",
                        j + 1, k, kLowStiffness, kHighStiffness));
    }
  }

  void JudgeResidual() {
    double square = 0;
    for (const LoadCase& load : cases_) square += load.displacement.squaredNorm();
    const double moved = std::sqrt(square / static_cast<double>(cases_.size()));
    const double left = moved > 0 ? 100 * found_.rms / moved : 0;
    const std::string share =
        fmt::format("elastic joints leave {:.3g} % of the displacements unexplained", left);
    if (found_.level <= 3) {
      result_.residual = fmt::format("as expected from the stated deviation; {}", share);
      return;
    }
    result_.residual = fmt::format(
        "{:.3g} times the stated deviation of {:.4g} mm: either the readings are that much less certain, or "
        "something "
        "else gives way (backlash, links, the sensor's support); {}",
        found_.level, options_.displacement_deviation, share);
    if (found_.level > kFarAbove) result_.findings.push_back("the residual is " + result_.residual);
  }

  const Arm& arm_;
  const std::vector<LoadCase>& cases_;
  const IdentifyOptions& options_;
  const Identification& found_;
  Plausibility result_;
};

}  // namespace

Plausibility JudgeIdentification(const Arm& arm, const std::vector<LoadCase>& cases,
                                 const IdentifyOptions& options, const Identification& found) {
  return Judge(arm, cases, options, found).Run();
}

}  // namespace millpose
