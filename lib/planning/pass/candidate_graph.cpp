// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/candidate_graph.hpp"

#include <algorithm>
#include <limits>

#include "planning/ladder/table_layer.hpp"

namespace millpose {

CandidateGraph::CandidateGraph(PassChecks checks, std::vector<Layer> layers, std::vector<Joints> max_step,
                               std::vector<std::shared_ptr<PointVerdicts>> known)
    : checks_(std::move(checks)),
      layers_(std::move(layers)),
      max_step_(std::move(max_step)),
      known_(std::move(known)),
      verdict_(layers_.size()),
      pair_(layers_.size()),
      barred_(layers_.size()),
      versions_(layers_.size(), 0),
      last_problem_(layers_.size()) {
  for (size_t t = 0; t < layers_.size(); ++t) {
    verdict_[t].assign(layers_[t].size(), Verdict::kUnknown);
    pair_[t].assign(layers_[t].size(), -1);
  }
}

std::optional<ContactCandidate> CandidateGraph::Meets(PassCheckers& checkers, size_t layer,
                                                      const FreedomValues& freedoms, const Joints& q) {
  return known_[layer]->OfCandidate(checkers.At(layer), freedoms, q, checks_);
}

bool CandidateGraph::Prunes(PassCheckers& checkers, size_t layer, size_t node) {
  Verdict& verdict = verdict_[layer][node];
  if (verdict != Verdict::kUnknown) return false;
  Layer& of = layers_[layer];
  const double gouge = checks_.gouges.At(of.joints.At(node));
  const std::optional<ContactCandidate> hit =
      gouge > 0 ? std::nullopt : Meets(checkers, layer, FreedomsOf(of, node), of.joints.At(node));
  verdict = hit || gouge > 0 ? Verdict::kBlocked : Verdict::kFree;
  if (verdict == Verdict::kFree) return false;
  last_problem_[layer] = CutProblem{hit, gouge};
  if (hit) pair_[layer][node] = hit->pair;
  ++versions_[layer];
  of.objective[node] = std::numeric_limits<double>::infinity();
  return true;
}

bool CandidateGraph::IsFree(PassCheckers& checkers, size_t layer, size_t node) {
  Prunes(checkers, layer, node);
  return verdict_[layer][node] == Verdict::kFree;
}

void CandidateGraph::TakeOut(size_t layer, size_t node) {
  Verdict& verdict = verdict_[layer][node];
  if (verdict == Verdict::kBlocked) return;
  double& objective = layers_[layer].objective[node];
  taken_.push_back({layer, node, objective, verdict});
  verdict = Verdict::kBlocked;
  objective = std::numeric_limits<double>::infinity();
  ++versions_[layer];
}

void CandidateGraph::GiveBack(const Sequence& sequence) {
  for (const Taken& taken : taken_) {
    if (sequence.nodes[taken.layer] == kNoNode) continue;
    layers_[taken.layer].objective[taken.node] = taken.objective;
    verdict_[taken.layer][taken.node] = taken.verdict;
    ++versions_[taken.layer];
  }
  taken_.clear();
}

std::optional<CandidateGraph::Transition> CandidateGraph::TransitionOf(const Sequence& sequence,
                                                                       size_t t) const {
  const size_t to = Next(t), a = sequence.nodes[t], b = sequence.nodes[to];
  if (a == kNoNode || b == kNoNode) return std::nullopt;
  if (to == 0 ? !sequence.closed : bool(sequence.break_before[to])) return std::nullopt;
  const Joints q = layers_[t].joints.At(a);
  return Transition{a, b, q, (layers_[to].joints.At(b) - q).unaryExpr(&WrapToPi)};
}

std::optional<CandidateGraph::Transition> CandidateGraph::TransitionBetween(size_t t, size_t from,
                                                                            size_t to) const {
  const Joints q = layers_[t].joints.At(from);
  const Joints step = (layers_[Next(t)].joints.At(to) - q).unaryExpr(&WrapToPi);
  if ((step.cwiseAbs().array() > max_step_[t].array()).any() || barred_[t].contains({from, to}))
    return std::nullopt;
  return Transition{from, to, q, step};
}

bool CandidateGraph::IsFree(PassCheckers& checkers, size_t t, const Transition& transition) {
  const Joints end = transition.q + transition.step;
  const double gouge = checks_.gouges.Between(transition.q, end);
  const std::optional<CutProblem> problem =
      gouge > 0 ? std::optional(CutProblem{{}, gouge})
                : known_[t]->OfMotion(checkers, t, transition.q, end, checks_);
  if (!problem) return true;
  last_problem_[t] = problem;
  Bar(t, transition);
  return false;
}

void CandidateGraph::Bar(size_t t, const Transition& transition) {
  barred_[t].insert({transition.from, transition.to});
  ++versions_[t];
}

void CandidateGraph::Unbar(size_t t, const Transition& transition) {
  barred_[t].erase({transition.from, transition.to});
  ++versions_[t];
}

void CandidateGraph::BoundStep(size_t t, const Joints& max_step) {
  max_step_[t] = max_step;
  ++versions_[t];
}

void CandidateGraph::InParallel(size_t count, const std::function<void(PassCheckers&, size_t)>& work) {
  counts_ += CheckInParallel(checks_, count, work);
}

long long CandidateGraph::nodes() const {
  long long count = 0;
  for (const Layer& layer : layers_) count += static_cast<long long>(layer.size());
  return count;
}

long long CandidateGraph::nodes_checked() const {
  long long checked = 0;
  for (const std::vector<Verdict>& layer : verdict_) {
    checked += std::count_if(layer.begin(), layer.end(), [](Verdict v) { return v != Verdict::kUnknown; });
  }
  return checked;
}

int CandidateGraph::nodes_pruned() const {
  std::ptrdiff_t pruned = 0;
  for (const std::vector<Verdict>& layer : verdict_) pruned += std::ranges::count(layer, Verdict::kBlocked);
  return static_cast<int>(pruned);
}

std::string CandidateGraph::Detail(size_t layer) const {
  if (!last_problem_[layer]) return {};
  const CutProblem& problem = *last_problem_[layer];
  Checker checker(problem.external.empty() ? checks_.WorldAt(layer) : checks_.world.At(problem.external));
  return Describe(checker, problem);
}

}  // namespace millpose
