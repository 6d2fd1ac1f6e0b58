// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/sample_plan.hpp"

#include "base/rotation.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/bound_turns.hpp"
#include "program/fanuc/fanuc.hpp"
#include "program/linuxcnc/linuxcnc.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

Joints Degrees(std::array<double, 6> degrees) { return Eigen::Map<Joints>(degrees.data()) * kRadPerDeg; }

/// The tool on a point of P, turned about its axis by `rotation` from the world's up.
Pose ToolOn(const Pose& X_WP, const Vector3d& p_P, double tilt, double rotation) {
  Pose X_WT = Pose::Identity();
  const Vector3d z =
      X_WP.linear() * (RotationAbout(Vector3d(1, 2, 0).normalized(), tilt) * Vector3d::UnitZ());
  const Vector3d x = (Vector3d::UnitZ() - z * z.z()).normalized();
  X_WT.linear().col(0) = x;
  X_WT.linear().col(1) = z.cross(x);
  X_WT.linear().col(2) = z;
  X_WT.linear() = X_WT.linear() * RotationAbout(Vector3d::UnitZ(), rotation);
  X_WT.translation() = X_WP * p_P;
  return X_WT;
}

bool Within(const Arm& arm, const Joints& q) {
  const Joints margin = Joints::Constant(3 * kRadPerDeg);
  return ((q - arm.lower - margin).array() >= 0).all() && ((arm.upper - margin - q).array() >= 0).all();
}

class SampleBuilder {
 public:
  explicit SampleBuilder(const SampleShape& shape) : tilt_(shape.tilt_deg * kRadPerDeg), lift_(shape.lift) {
    plan_.job = "Sample wall-plan";
    plan_.cell = "kr500_r2830";
    plan_.input_hash = "0123456789abcdef";
    plan_.arm = SampleArm();
    plan_.X_WB.translation().z() = 100;
    plan_.X_FT = SampleTool();
    plan_.X_WP.translation() = Vector3d(2076, 30, 1106);
    plan_.X_WP.linear() = RotationAbout(Vector3d::UnitZ(), shape.wall_yaw_deg * kRadPerDeg) *
                          RotationAbout(Vector3d::UnitY(), shape.wall_turn_deg * kRadPerDeg);
    plan_.home = Degrees({0, -90, 90, 0, 0, 0});
    plan_.spindle_speed = 7000.0 / 60;
    FindStart();
  }

  void AddPass(const std::vector<Vector3d>& places, bool closed) {
    PassResult& pass = plan_.passes.emplace_back();
    pass.pass = static_cast<int>(plan_.passes.size()) - 1;
    Joints q = start_;
    for (size_t i = 0; i < places.size(); ++i) {
      PlannedPoint& planned = pass.points.emplace_back();
      const double rotation = rotation_ + 0.01 * SinCos(2 * kPi * static_cast<double>(i) / places.size()).sin;
      const Pose X_WT = ToolOn(plan_.X_WP, places[i], tilt_, rotation);
      q = Solve(X_WT, q);
      planned.q = q;
      planned.branch = branch_;
      planned.point.position = X_WT.translation();
      planned.point.tool_axis = X_WT.linear().col(2);
      planned.point.normal = planned.point.tool_axis;
      planned.point.feed_rate = 80.0 / 60;
      planned.freedoms = {rotation};
    }
    pass.pieces.push_back({pass.pass, 0, 0, static_cast<int>(places.size()) - 1, closed});
  }

  PlanResult Finish() {
    for (size_t i = 0; i <= plan_.passes.size(); ++i) {
      LinkMove& gap = plan_.gaps.emplace_back();
      gap.planned = true;
      if (i > 0) {
        const PassResult& from = plan_.passes[i - 1];
        gap.from_pass = from.pass;
        gap.from_piece = 0;
        const Joints& last = from.pieces[0].closed ? from.points.front().q : from.points.back().q;
        gap.joints.push_back(Above(last, gap.X_WT_retracted));
      } else {
        gap.joints.push_back(plan_.home);
        gap.joints.push_back(Degrees({5, -95, 100, 10, 20, -10}));
      }
      if (i < plan_.passes.size()) {
        gap.to_pass = plan_.passes[i].pass;
        gap.to_piece = 0;
        gap.joints.push_back(Above(plan_.passes[i].points.front().q, gap.X_WT_approach));
      } else {
        gap.joints.push_back(Degrees({5, -95, 100, 10, 20, -10}));
        gap.joints.push_back(plan_.home);
      }
    }
    return std::move(plan_);
  }

 private:
  Pose FlangeOf(const Pose& X_WT) const { return plan_.X_WB.inverse() * X_WT * plan_.X_FT.inverse(); }

  void FindStart() {
    for (int degree = 0; degree < 360; ++degree) {
      const InverseResult inverse =
          Inverse(plan_.arm, FlangeOf(ToolOn(plan_.X_WP, Vector3d::Zero(), tilt_, degree * kRadPerDeg)));
      for (int s = 0; s < inverse.count; ++s) {
        const Joints& q = inverse.solutions[s].q;
        const bool apart =
            DistanceToSingularity(plan_.arm, q).wrist > 0.3 && (q.cwiseAbs().array() < 2.6).all();
        if (!Within(plan_.arm, q) || !apart) continue;
        rotation_ = degree * kRadPerDeg;
        branch_ = inverse.solutions[s].branch;
        start_ = q;
        return;
      }
    }
    throw std::logic_error("the sample is out of reach");
  }

  Joints Solve(const Pose& X_WT, const Joints& near) const {
    return InverseNear(plan_.arm, FlangeOf(X_WT), branch_, near).value();
  }

  Joints Above(const Joints& q, Pose& X_WT) const {
    X_WT = plan_.X_WB * ForwardFlange(plan_.arm, q) * plan_.X_FT * Eigen::Translation3d(0, 0, lift_);
    return Solve(X_WT, q);
  }

  PlanResult plan_;
  double tilt_, lift_;
  double rotation_ = 0;
  int branch_ = 0;
  Joints start_;
};

}  // namespace

Arm SampleArm() {
  Arm arm;
  arm.name = "KUKA KR 500 R2830";
  arm.d1 = 1045, arm.a1 = 500, arm.a2 = 1300, arm.d4 = 1025, arm.dz = -55, arm.d6 = 290;
  arm.sign = {-1, 1, 1, -1, 1, -1};
  arm.lower = Degrees({-185, -130, -100, -350, -120, -350});
  arm.upper = Degrees({185, 20, 144, 350, 120, 350});
  arm.speed = Degrees({80, 75, 70, 70.5, 70.5, 109.7});
  arm.acceleration = Degrees({200, 200, 200, 300, 300, 500});
  return arm;
}

Pose SampleTool() {
  Pose X_FT = Pose::Identity();
  X_FT.translation() = Vector3d(-250, 0, 250);
  X_FT.linear() << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  return X_FT;
}

PlanResult SamplePlan(const SampleShape& shape) {
  SampleBuilder builder(shape);
  const double length = shape.spacing * (shape.points - 1);
  for (int pass = 0; pass < shape.passes; ++pass) {
    std::vector<Vector3d> places;
    for (int i = 0; i < shape.points; ++i) {
      const double along = pass % 2 ? length - i * shape.spacing : i * shape.spacing;
      places.emplace_back(along - length / 2, shape.stepover * (pass - (shape.passes - 1) / 2.0), 0);
    }
    builder.AddPass(places, false);
  }
  if (shape.ring) {
    std::vector<Vector3d> places;
    for (int i = 0; i < 2 * shape.points; ++i) {
      const SineCosine turn = SinCos(kPi * i / shape.points);
      places.emplace_back(20 * turn.cos, 20 * turn.sin, 0);
    }
    builder.AddPass(places, true);
  }
  return builder.Finish();
}

MotionOptions SampleFeeds() {
  MotionOptions options;
  options.approach_feed = 1000.0 / 60;
  options.approach_slow = 5;
  options.plunge_feed = 40.0 / 60;
  options.retract_feed = 2000.0 / 60;
  return options;
}

PostSettings SampleSettings(const std::string& variant) {
  PostSettings settings;
  settings.X_FT = SampleTool();
  settings.tool_name = "SPINDLE_D20";
  if (ControllerOf(variant) == "krl") {
    settings.tool_axis = FrameAxis::kX;
    settings.texts = {{"spindle_on", "$ANOUT[1]={rpm}\n$OUT[1]=TRUE"}, {"spindle_off", "$OUT[1]=FALSE"}};
  }
  if (ControllerOf(variant) == "urscript") {
    settings.load = ToolLoad{85, {-120, 0, 130}, {4, 5, 6}};
    settings.max_corner = 0.05;
    settings.texts = {
        {"spindle_on", "set_standard_analog_out(0, {rpm}/24000)\nset_standard_digital_out(0, True)"},
        {"spindle_off", "set_standard_digital_out(0, False)"}};
  }
  if (ControllerOf(variant) == "rapid") {
    settings.tool_axis = FrameAxis::kMinusZ;
    settings.load = ToolLoad{85, {-120, 0, 130}, {4, 5, 6}};
    settings.texts = {{"spindle_on", "SetAO spindle,{rpm};\nSetDO do1,1;"}, {"spindle_off", "SetDO do1,0;"}};
  }
  if (variant == "sinumerik_euler") settings.rotation = AngleOrder::kEuler;
  if (ControllerOf(variant) == "fanuc") {
    settings.axes = SampleFanucAxes();
    if (variant == "fanuc_cnt" || variant == "fanuc_cr") settings.max_corner = 0.1;
    settings.texts = {{"spindle_on", "AO[1]={rpm}\nDO[1]=ON"}, {"spindle_off", "DO[1]=OFF"}};
  }
  return settings;
}

AxisConvention SampleFanucAxes() {
  Matrix6 matrix = Matrix6::Zero();
  matrix.diagonal() << -1, 1, -1, 1, -1, 1;
  matrix(2, 1) = -1;
  return {matrix, (Joints() << 0, kPi / 2, 0, 0, 0, 0).finished()};
}

std::unique_ptr<Post> SamplePost(const std::string& variant) {
  if (ControllerOf(variant) == "fanuc")
    return std::make_unique<FanucPost>(
        FanucOptions{.user_frame = 1,
                     .tool_frame = 2,
                     .position_register = variant == "fanuc_held" ? 0 : 90,
                     .world_height = SampleArm().d1,
                     .corner_region = variant == "fanuc_cr",
                     .acceleration_time = variant == "fanuc_cnt" ? std::optional(0.1) : std::nullopt});
  if (variant == "linuxcnc_cartesian")
    return std::make_unique<LinuxCncPost>(LinuxCncOptions{true, std::nullopt});
  return MakePost(ControllerOf(variant));
}

MotionProgram Prepared(const MotionProgram& program, const std::string& variant, const PostSettings& settings,
                       const Arm& arm) {
  return Prepared(program, *SamplePost(variant), settings, arm);
}

MotionProgram Prepared(const MotionProgram& program, const Post& post, const PostSettings& settings,
                       const Arm& arm) {
  MotionProgram prepared = program;
  if (post.Name() != "sinumerik" && post.Name() != "fanuc") return prepared;
  std::vector<size_t> origin(program.motions.size());
  for (size_t i = 0; i < origin.size(); ++i) origin[i] = i;
  BoundTurns(prepared, origin, arm, {post.Lines(settings), WrittenTolerance({}).angle});
  return prepared;
}

std::string ControllerOf(const std::string& variant) { return variant.substr(0, variant.find('_')); }

}  // namespace millpose
