// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/candidate_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/process.hpp"

namespace millpose {
namespace {

/// Even steps from end to end; of a periodic freedom without the second end.
std::vector<double> EvenGrid(const Freedom& freedom, int intervals) {
  const double lower = freedom.Lower(), step = (freedom.Upper() - lower) / intervals;
  std::vector<double> values;
  for (int i = 0; i < intervals + (freedom.Periodic() ? 0 : 1); ++i) values.push_back(lower + i * step);
  return values;
}

/// Its own steps about its nominal value, and the ends.
std::vector<double> OwnGrid(const Freedom& freedom) {
  constexpr double kSame = 1e-9;
  const double lower = freedom.Lower(), upper = freedom.Upper(), nominal = freedom.Nominal();
  const auto steps = [&](double way) { return static_cast<int>(std::floor(way / freedom.Step() + kSame)); };
  std::vector<double> values;
  for (int i = -steps(nominal - lower); i <= steps(upper - nominal); ++i)
    values.push_back(std::clamp(nominal + i * freedom.Step(), lower, upper));
  if (values.front() > lower + kSame) values.insert(values.begin(), lower);
  if (values.back() < upper - kSame) values.push_back(upper);
  return values;
}

/// Settings are numbered by 32 bits.
void CheckSize(const std::vector<std::vector<double>>& values) {
  double settings = 1;
  for (const std::vector<double>& of : values) settings *= static_cast<double>(of.size());
  constexpr double kAnyMachineHas = 1e6;  // bytes; the machine is asked at microseconds a time
  if (CandidateTable::BytesOf(settings) < kAnyMachineHas) return;
  const double bytes = CandidateTable::BytesOf(settings), most = MachineMemory() / 2;
  if (bytes > most || settings > std::numeric_limits<uint32_t>::max())
    throw InputError({}, fmt::format("path.rotation_step_deg and the steps of toolpath's freedoms: one point "
                                     "would have {:.3g} candidates in {:.3g} MB; allowed: at most {:.3g} MB, "
                                     "half of the machine's memory; give larger steps",
                                     8 * settings, bytes / 1e6, most / 1e6));
}

}  // namespace

CandidateTable CandidateTable::OfStep(const PointScorer& scorer, double step) {
  std::vector<std::vector<double>> values;
  for (const auto& freedom : scorer.problem().freedoms) {
    const double range = freedom->Upper() - freedom->Lower();
    values.push_back(freedom->Step() > 0
                         ? OwnGrid(*freedom)
                         : EvenGrid(*freedom, std::max(1, static_cast<int>(std::ceil(range / step - 1e-9)))));
  }
  return {scorer, std::move(values)};
}

CandidateTable CandidateTable::OfSize(const PointScorer& scorer, int settings) {
  const size_t dimensions = scorer.problem().freedoms.size();
  int each = 2;
  const auto fits = [&](int count) {
    double product = 1;
    for (size_t d = 0; d < dimensions; ++d) product *= count;
    return product <= settings;
  };
  while (fits(each + 1)) ++each;
  std::vector<std::vector<double>> values;
  for (const auto& freedom : scorer.problem().freedoms)
    values.push_back(EvenGrid(*freedom, freedom->Periodic() ? each : each - 1));
  return {scorer, std::move(values)};
}

double CandidateTable::At(size_t d, int i) const {
  if (d > 0) return values_[d][static_cast<size_t>(i)];
  return values_[0][0] + i * first_step_;
}

CandidateTable::CandidateTable(const PointScorer& scorer, std::vector<std::vector<double>> grid)
    : values_(std::move(grid)) {
  const auto& freedoms = scorer.problem().freedoms;
  const size_t dimensions = freedoms.size();
  const size_t intervals = values_[0].size() - (freedoms[0]->Periodic() ? 0 : 1);
  first_step_ = (freedoms[0]->Upper() - freedoms[0]->Lower()) / static_cast<double>(intervals);
  CheckSize(values_);
  for (const std::vector<double>& of : values_) settings_ *= of.size();
  // Line by line, so that the settings of a block share what the first freedom leaves as it is.
  const size_t length = values_[0].size(), lines = stride();
  const auto setting = [&](size_t k) { return k % length * lines + k / length; };
  std::vector<double> values(kLanes * dimensions);
  ScoredBlock block;
  for (size_t first = 0; first < settings_; first += kLanes) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      size_t rest = setting(std::min(first + lane, settings_ - 1));  // the last fills up
      for (size_t d = dimensions; d-- > 0; rest /= values_[d].size())
        values[lane * dimensions + d] = At(d, static_cast<int>(rest % values_[d].size()));
    }
    scorer.ScoreBlock(values, kAllArmBranches, block);
    for (size_t lane = 0; lane < kLanes && first + lane < settings_; ++lane) {
      for (int branch = 0; branch < 8; ++branch) {
        const Infeasibility obstacle = block.obstacle[branch][lane];
        if (obstacle != Infeasibility::kNone) {
          reason_ = std::max(reason_, obstacle);
          continue;
        }
        const Candidate candidate = CandidateOf(block, branch, static_cast<int>(lane));
        entries_.push_back({static_cast<uint32_t>(setting(first + lane)), static_cast<uint8_t>(branch),
                            candidate.objective, candidate.q});
      }
    }
  }
  if (lines > 1) std::ranges::stable_sort(entries_, {}, [](const Entry& entry) { return entry.setting; });
  if (!entries_.empty()) reason_ = Infeasibility::kNone;
}

FreedomValues CandidateTable::Setting(size_t index) const {
  FreedomValues values(values_.size());
  for (size_t d = values_.size(); d-- > 0; index /= values_[d].size())
    values[d] = At(d, static_cast<int>(index % values_[d].size()));
  return values;
}

}  // namespace millpose
