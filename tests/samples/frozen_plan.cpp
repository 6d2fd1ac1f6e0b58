// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/samples/frozen_plan.hpp"

#include <sstream>

#include "base/file.hpp"
#include "job/assemble.hpp"
#include "job/workpiece.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

std::string Angles(const Joints& q) {
  std::string text;
  for (const double angle : q) text += fmt::format(" {:.17g}", angle);
  return text;
}

Joints ReadAngles(std::istream& line) {
  Joints q;
  for (double& angle : q) line >> angle;
  return q;
}

}  // namespace

std::string Freeze(const PlanResult& plan) {
  std::string text = fmt::format("home{}\n", Angles(plan.home));
  for (const PassResult& pass : plan.passes) {
    for (const Segment& piece : pass.pieces) {
      text += fmt::format("piece {} {} {}\n", pass.pass, piece.piece, piece.closed ? 1 : 0);
      for (int i = piece.first; i <= piece.last; ++i)
        text += fmt::format("point {:.17g}{}\n", pass.points[i].point.feed_rate, Angles(pass.points[i].q));
    }
  }
  for (const LinkMove& gap : plan.gaps) {
    text += fmt::format("gap {} {} {} {} {:.17g}\n", gap.from_pass, gap.from_piece, gap.to_pass, gap.to_piece,
                        gap.clearance_share);
    for (const Joints& q : gap.joints) text += fmt::format("joints{}\n", Angles(q));
  }
  return text;
}

PlanResult Thaw(const std::string& text, const JobInputs& inputs, const Cell& cell) {
  PlanResult plan;
  plan.job = inputs.job.name;
  plan.cell = inputs.cell.name;
  plan.input_hash = "0123456789abcdef";
  plan.arm = cell.arm;
  plan.X_WB = cell.X_WB;
  plan.X_FT = cell.X_FT;
  plan.X_WP = cell.X_WP;
  plan.spindle_speed = inputs.job.spindle_speed;
  std::istringstream lines(text);
  for (std::string all; std::getline(lines, all);) {
    std::istringstream line(all);
    std::string word;
    line >> word;
    if (word == "home") {
      plan.home = ReadAngles(line);
    } else if (word == "piece") {
      int number = 0, piece = 0, closed = 0;
      line >> number >> piece >> closed;
      while (static_cast<int>(plan.passes.size()) <= number) {
        plan.passes.emplace_back();
        plan.passes.back().pass = static_cast<int>(plan.passes.size()) - 1;
      }
      PassResult& pass = plan.passes.back();
      const int first = static_cast<int>(pass.points.size());
      pass.pieces.push_back({number, piece, first, first - 1, closed == 1});
    } else if (word == "point") {
      PassResult& pass = plan.passes.back();
      PlannedPoint& point = pass.points.emplace_back();
      line >> point.point.feed_rate;
      point.q = ReadAngles(line);
      pass.pieces.back().last += 1;
    } else if (word == "gap") {
      LinkMove& gap = plan.gaps.emplace_back();
      line >> gap.from_pass >> gap.from_piece >> gap.to_pass >> gap.to_piece >> gap.clearance_share;
      gap.planned = true;
    } else if (word == "joints") {
      plan.gaps.back().joints.push_back(ReadAngles(line));
    }
  }
  return plan;
}

Sample LoadSample(const std::string& name) {
  const std::filesystem::path source = SourceDir();
  Sample sample;
  sample.inputs = LoadJobInputs(source / "toolpaths" / name / "job.yaml", {});
  sample.cell = MakeJobCell(sample.inputs);
  sample.plan = Thaw(ReadFile(source / "tests/samples/plans" / (name + ".txt")), sample.inputs, sample.cell);
  return sample;
}

std::vector<std::string> SampleNames() { return {"support_pad", "cabin_panel", "cabin_ring"}; }

}  // namespace millpose
