// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/registry.hpp"
#include "machine/robot/arm.hpp"
#include "machine/stiffness/compliance_block.hpp"
#include "machine/stiffness/force_cone.hpp"

namespace millpose {

/// What an objective may know of the milling point; unit vectors and force in the frame of the
/// compliance.
struct ObjectiveContext {
  Eigen::Vector3d normal, feed, tool_axis;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< mean, on the tool, N; zero where it is not known
};

/// Numbers that an objective takes from the job, by key (w1, w2, …).
using ObjectiveParameters = std::map<std::string, double>;

/// What is minimised over the freedoms of a point. An implementation is a file in objectives/, which ends
/// with its ObjectiveEntry, and a line in objective.cpp.
class Objective {
 public:
  virtual ~Objective() = default;
  /// What the job gave: together with its name all that it depends on.
  const ObjectiveParameters& parameters() const { return parameters_; }
  virtual std::string Name() const = 0;
  virtual std::string Unit() const = 0;
  /// Whether values change when the feed is reversed: then a pass is planned and milled the way it is laid.
  virtual bool DependsOnFeed() const = 0;
  /// Whether it reads the force of the context, which a job's process.cutting gives.
  virtual bool NeedsForce() const { return false; }
  /// Where whole ways are judged by the error of the face too, with the gears' lost motion: how sure the
  /// force is then (docs/face-error.md).
  virtual std::optional<ForceBounds> JudgesFace() const { return std::nullopt; }
  /// Whether it reads the tool axis of the context, which differs between leans.
  virtual bool ReadsToolAxis() const { return true; }
  /// One value per lane; +inf where it is not defined (singular compliance), never NaN.
  virtual void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const = 0;

 private:
  friend std::unique_ptr<Objective> MakeObjective(const std::string& name,
                                                  const ObjectiveParameters& parameters);
  ObjectiveParameters parameters_;
};

/// An objective without parameters that does not depend on the feed; `unit` as reports show it.
class PlainObjective : public Objective {
 public:
  PlainObjective(const char* name, const char* unit) : name_(name), unit_(unit) {}
  std::string Name() const override { return name_; }
  std::string Unit() const override { return unit_; }
  bool DependsOnFeed() const override { return false; }
  bool ReadsToolAxis() const override { return false; }

 private:
  const char *name_, *unit_;
};

/// A parameter that an objective knows.
struct ParameterRule {
  std::string name;
  double fallback;  ///< when the job does not give it
  double minimum;   ///< least allowed value
  /// Where the job gives one of these words, the value is the word's index; else empty.
  std::vector<std::string> words = {};
  std::string doc = {};  ///< what the words mean, for the reference page
};

/// What the registry knows of an objective before it is made.
struct ObjectiveEntry {
  std::string name;
  std::vector<ParameterRule> parameters;
  /// Gets every parameter, given or fallback, each finite and not below its minimum. Throws InputError for
  /// values that make no sense together.
  std::function<std::unique_ptr<Objective>(const ObjectiveParameters& all)> make;
  bool worst_first = false;  ///< jobs that do not say otherwise care for the worst point before the sum
  bool with_force = false;   ///< taken where a job knows the cutting force and names no objective: one alone
  bool of_paper = false;     ///< eq. 23 of Chen et al. 2021, which formulation paper follows: one alone
  /// Taken in place of that with_force where the cell knows the lost motion of its gears too: one alone.
  bool with_lost_motion = false;
};

/// All objectives; programs that link the library may add theirs.
Registry<ObjectiveEntry>& Objectives();

/// The one entry for which `is` holds.
const ObjectiveEntry& TheObjective(bool ObjectiveEntry::*is);

/// The objective registered under `name`. Throws InputError for an unknown name or parameter, naming the
/// nearest, and for values that are not allowed.
std::unique_ptr<Objective> MakeObjective(const std::string& name, const ObjectiveParameters& parameters);

}  // namespace millpose
