// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "robot/arm.hpp"
#include "stiffness/compliance_block.hpp"

namespace millpose {

/// What an objective may know of the milling point; unit vectors in the frame of the compliance.
struct ObjectiveContext {
  Eigen::Vector3d normal, feed, tool_axis;
};

/// Numbers that an objective takes from the job, by key (w1, w2, …).
using ObjectiveParameters = std::map<std::string, double>;

/// What is minimised over the freedoms of a point. An implementation is a file in objectives/ and an entry in
/// objective.cpp.
class Objective {
 public:
  virtual ~Objective() = default;
  /// What it was made with: together with its name all that it depends on.
  const ObjectiveParameters& parameters() const { return parameters_; }
  virtual std::string Name() const = 0;
  virtual std::string Unit() const = 0;
  /// One value per lane; +inf where it is not defined (singular compliance), never NaN.
  virtual void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const = 0;

 private:
  friend std::unique_ptr<Objective> MakeObjective(const std::string& name,
                                                  const ObjectiveParameters& parameters);
  ObjectiveParameters parameters_;
};

/// The objective registered under `name`. Throws InputError for an unknown name or parameter, naming the
/// nearest.
std::unique_ptr<Objective> MakeObjective(const std::string& name, const ObjectiveParameters& parameters);
std::vector<std::string> ObjectiveNames();

}  // namespace millpose
