// SPDX-License-Identifier: GPL-3.0-or-later
// The fields of a plan as plan.cbor.gz has them (docs/plan-format.md): each type lists its own once, in
// order, for serialise.cpp alone.
#pragma once

#include "planning/result/plan_result.hpp"

namespace millpose {

template <class Archive>
void Fields(Archive& a, Engagement& e) {
  a("force", e.force);
  a("width", e.width);
  a("depth", e.depth);
  a("side", e.side);
}

template <class Archive>
void Fields(Archive& a, MillingPoint& p) {
  a("position", p.position);
  a("normal", p.normal);
  a("feed", p.feed);
  a("tool_axis", p.tool_axis);
  a("feed_rate", p.feed_rate);
  a("arc_length", p.arc_length);
  a("kind", p.kind);
  a("region", p.region);
  a("source_line", p.source_line);
  a("gouge", p.gouge);
  a("engagement", p.engagement);
}

template <class Archive>
void Fields(Archive& a, MillingPlaneIndices& i) {
  a("lambda_t1", i.lambda_t1);
  a("lambda_t2", i.lambda_t2);
  a("lambda_n", i.lambda_n);
  a("mu", i.mu);
  a("normal_compliance", i.normal_compliance);
}

template <class Archive>
void Fields(Archive& a, PaperAnswer& p) {
  a("within_tolerance", p.within_tolerance);
  a("position_error", p.position_error);
  a("angle_error", p.angle_error);
  a("objective", p.objective);
}

template <class Archive>
void Fields(Archive& a, Compensation::Along& d) {
  a("low", d.low);
  a("expected", d.expected);
  a("high", d.high);
  a("taken", d.taken);
}

template <class Archive>
void Fields(Archive& a, Compensation& c) {
  a("q", c.q);
  a("shift", c.shift);
  a("weight", c.weight);
  a("force", c.force);
  a("normal", c.normal);
  a("across", c.across);
  a("map", c.map);
  a("bounded", c.bounded);
  a("arm_shift", c.arm_shift);
  a("arm_turn", c.arm_turn);
  a("gear_shift", c.gear_shift);
  a("arm_left", c.arm_left);
}

template <class Archive>
void Fields(Archive& a, NearestPair& p) {
  a("first", p.first);
  a("second", p.second);
  a("first_end", p.first_end);
  a("second_end", p.second_end);
}

template <class Archive>
void Fields(Archive& a, PlannedPoint& p) {
  a("point", p.point);
  a("skip", p.skip);
  a("detail", p.detail);
  a("piece", p.piece);
  a("freedoms", p.freedoms);
  a("branch", p.branch);
  a("q", p.q);
  a("indices", p.indices);
  a("lambda_3", p.lambda_3);
  a("lambda_3_direction", p.lambda_3_direction);
  a("dexterity", p.dexterity);
  a("objective", p.objective);
  a("unsmoothed", p.unsmoothed);
  a("free_optimum", p.free_optimum);
  a("genetic_optimum", p.genetic_optimum);
  a("own_optimum", p.own_optimum);
  a("exhaustive_optimum", p.exhaustive_optimum);
  a("own_rotation", p.own_rotation);
  a("free_rotation", p.free_rotation);
  a("own_branch", p.own_branch);
  a("free_branch", p.free_branch);
  a("barred", p.barred);
  a("verdicts", p.verdicts);
  a("genetic_evaluations", p.genetic_evaluations);
  a("paper", p.paper);
  a("from_genetic", p.from_genetic);
  a("clearance", p.clearance);
  a("nearest", p.nearest);
  a("compensation", p.compensation);
  a("external", p.external);
}

template <class Archive>
void Fields(Archive& a, Segment& p) {
  a("pass", p.pass);
  a("piece", p.piece);
  a("first", p.first);
  a("last", p.last);
  a("closed", p.closed);
}

template <class Archive>
void Fields(Archive& a, Smoothing& s) {
  a("square_before", s.square_before);
  a("square_after", s.square_after);
  a("objective_before", s.objective_before);
  a("objective_after", s.objective_after);
}

template <class Archive>
void Fields(Archive& a, LadderBound& b) {
  a("cost", b.cost);
  a("cost_bound", b.cost_bound);
  a("worst", b.worst);
  a("worst_bound", b.worst_bound);
}

template <class Archive>
void Fields(Archive& a, PassResult& p) {
  a("pass", p.pass);
  a("rotation_reference", p.rotation_reference);
  a("external", p.external);
  a("points", p.points);
  a("pieces", p.pieces);
  a("grid_gap", p.grid_gap);
  a("poses_checked", p.poses_checked);
  a("nodes_pruned", p.nodes_pruned);
  a("nodes", p.nodes);
  a("nodes_checked", p.nodes_checked);
  a("pairs_checked", p.pairs_checked);
  a("pairs_saved", p.pairs_saved);
  a("smoothing", p.smoothing);
  a("bound", p.bound);
  a("pairs", p.pairs);
  a("bodies", p.bodies);
  a("uncut", p.uncut);
  a("lifts", p.lifts);
  a("lift_gain", p.lift_gain);
  a("stripe", p.stripe);
  a("opened_at", p.opened_at);
}

template <class Archive>
void Fields(Archive& a, ExternalMove& m) {
  a("from", m.from);
  a("to", m.to);
  a("at", m.at);
  a("duration", m.duration);
}

template <class Archive>
void Fields(Archive& a, LinkMove& g) {
  a("from_pass", g.from_pass);
  a("from_piece", g.from_piece);
  a("to_pass", g.to_pass);
  a("to_piece", g.to_piece);
  a("planned", g.planned);
  a("detail", g.detail);
  a("X_WT_retracted", g.X_WT_retracted);
  a("X_WT_approach", g.X_WT_approach);
  a("joints", g.joints);
  a("clearance", g.clearance);
  a("clearance_share", g.clearance_share);
  a("duration", g.duration);
  a("external", g.external);
  a("poses_checked", g.poses_checked);
}

template <class Archive>
void Fields(Archive& a, CoupledLimit& limit) {
  a("factors", limit.factors);
  a("at_most", limit.at_most);
}

template <class Archive>
void Fields(Archive& a, Arm& arm) {
  a("name", arm.name);
  a("family", arm.family);
  a("d1", arm.d1);
  a("a1", arm.a1);
  a("dy", arm.dy);
  a("a2", arm.a2);
  a("d4", arm.d4);
  a("dz", arm.dz);
  a("d5", arm.d5);
  a("d6", arm.d6);
  a("sign", arm.sign);
  a("offset", arm.offset);
  a("lower", arm.lower);
  a("upper", arm.upper);
  a("coupled_limits", arm.coupled_limits);
  a("speed", arm.speed);
  a("acceleration", arm.acceleration);
  a("acceleration_assumed", arm.acceleration_assumed);
  a("stiffness", arm.stiffness);
}

template <class Archive>
void Fields(Archive& a, ExternalAxis& axis) {
  a("name", axis.name);
  a.Words("kind", axis.kind, kAxisKindWords);
  a.Words("carries", axis.carries, kCarriesWords);
  a("direction", axis.direction);
  a("origin", axis.origin);
  a("lower", axis.lower);
  a("upper", axis.upper);
  a("home", axis.home);
  a("speed", axis.speed);
  a("acceleration", axis.acceleration);
  a("compliance", axis.compliance);
}

template <class Archive>
void Fields(Archive& a, PlanResult& r) {
  a("job", r.job);
  a("cell", r.cell);
  a("input_hash", r.input_hash);
  a("seed", r.seed);
  a("arm", r.arm);
  a("external_axes", r.external_axes);
  a("X_WB", r.X_WB);
  a("X_FT", r.X_FT);
  a("X_WP", r.X_WP);
  a("home", r.home);
  a("spindle_speed", r.spindle_speed);
  a("passes", r.passes);
  a("gaps", r.gaps);
  a("objective_name", r.objective_name);
  a("objective_unit", r.objective_unit);
  a.Words("stiffness_origin", r.stiffness_origin, kStiffnessOriginWords);
}

}  // namespace millpose
