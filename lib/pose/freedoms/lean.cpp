// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/rotation.hpp"
#include "pose/freedom.hpp"

namespace millpose {
namespace {

/// Leans the tool about the contact, which stays where it is; the tip follows from cutter and axis.
class LeanOfTool : public Freedom {
 public:
  explicit LeanOfTool(const LeanRange& range) : range_(range) {}
  double Lower() const override { return range_.from; }
  double Upper() const override { return range_.to; }
  bool Periodic() const override { return false; }
  double Step() const override { return range_.step; }
  double Nominal() const override { return range_.nominal; }
  bool IsLean() const override { return true; }
  ToolStance Lean(const CutterContact& contact, const ToolStance& from, double value) const override {
    const Eigen::Vector3d axis = RotationAbout(About(contact), value) * from.axis;
    return {TipAtContact(contact.cutter, contact.place, contact.normal, axis), axis};
  }

 private:
  virtual Eigen::Vector3d About(const CutterContact& contact) const = 0;
  LeanRange range_;
};

/// Towards the feed.
class Lead final : public LeanOfTool {
 public:
  using LeanOfTool::LeanOfTool;
  std::string Name() const override { return "lead"; }

 private:
  Eigen::Vector3d About(const CutterContact& contact) const override {
    return contact.normal.cross(contact.feed);
  }
};

/// To the right of the feed, seen against the normal.
class Tilt final : public LeanOfTool {
 public:
  using LeanOfTool::LeanOfTool;
  std::string Name() const override { return "tilt"; }

 private:
  Eigen::Vector3d About(const CutterContact& contact) const override { return contact.feed; }
};

}  // namespace

FreedomEntry LeadEntry() {
  return {"lead", [](const LeanRange& range) { return std::make_unique<Lead>(range); }};
}

FreedomEntry TiltEntry() {
  return {"tilt", [](const LeanRange& range) { return std::make_unique<Tilt>(range); }};
}

}  // namespace millpose
