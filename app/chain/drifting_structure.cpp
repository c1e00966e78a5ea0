#include "app/chain/drifting_structure.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "filter/learn/competitors/drifting.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/lag/structure_choice.hpp"

namespace modebank {
namespace {

constexpr Index most_asked_transitions = 20000, most_equal_lags = 8;
constexpr double least_drifting_gain = 0.02;  // [nats/sample]

LinearStructure structure_of(const StructureScore& s, const Recording& recording, const FitOptions& window) {
  return {
      recording.state_count(), recording.input_count(), window.intercept, s.state_lags, s.input_lags, s.input_delay};
}

class DriftingChoice {
 public:
  DriftingChoice(const Recording& recording, const FitOptions& window, Index latest)
      : recording_(recording), window_(window), latest_(latest) {}

  /// Minus infinity where it cannot be learned.
  double score(const StructureScore& of, const DriftingGrid& grid) const {
    return drifting_training_score(recording_, latest_, structure_of(of, recording_, window_), TimeSteps::single, grid);
  }

 private:
  const Recording& recording_;
  const FitOptions& window_;
  Index latest_;
};

/// The finalists, and others that only wandering coefficients are asked about.
std::vector<StructureScore> candidates_of(const FoundStructure& found, const StructureInputs& inputs) {
  std::vector<StructureScore> candidates = found.scores;
  const auto is_there = [&](const StructureScore& s) {
    return std::any_of(candidates.begin(), candidates.end(), [&](const StructureScore& c) {
      return c.state_lags == s.state_lags && c.input_lags == s.input_lags && c.input_delay == s.input_delay;
    });
  };
  for (Index k = 1; k <= most_equal_lags; ++k) {
    StructureScore equal;
    equal.state_lags = inputs.searched.state ? k : found.state_lags;
    equal.input_lags = inputs.searched.input ? k : found.input_lags;
    equal.input_delay = found.scores.front().input_delay;
    const Index memory = std::max(equal.state_lags, equal.input_delay + equal.input_lags - 1);
    if (inputs.searched.most_samples > 0 && memory > inputs.searched.most_samples) break;
    equal.log_score = equal.loss = equal.loss_standard_error = not_a_number;
    equal.rmse = Eigen::VectorXd::Constant(found.scores.front().rmse.size(), not_a_number);
    if (!is_there(equal)) candidates.push_back(equal);
  }
  return candidates;
}

void choose(FoundStructure& found, std::vector<StructureScore> candidates, const Recording& recording, double samples) {
  double best = -std::numeric_limits<double>::infinity();
  for (const StructureScore& c : candidates) best = std::max(best, c.drifting_score);
  const double slack = loss_by_chance(samples);
  const StructureSize of_lags{recording.state_count(), recording.input_count()};
  const auto size = [&](const StructureScore& c) { return of_lags({c.state_lags, c.input_lags, c.input_delay}); };
  StructureScore* chosen = nullptr;
  for (StructureScore& c : candidates) {
    c.chosen = false;
    if (c.drifting_score < best - slack) continue;
    if (!chosen || size(c) < size(*chosen)) chosen = &c;
  }
  if (!chosen) return;  // without candidates
  chosen->chosen = true;
  found.state_lags = chosen->state_lags;
  found.input_lags = chosen->input_lags;
  found.input_delay = chosen->input_delay;
  found.by_drifting = true;
  found.scores = std::move(candidates);
}

}  // namespace

void let_drifting_choose(const Recording& recording, const StructureInputs& inputs, FoundStructure& found) {
  const Index transitions = recording.transitions(Role::train);
  if (found.scores.empty() || transitions > most_asked_transitions) return;
  std::vector<StructureScore> candidates = candidates_of(found, inputs);
  Index latest = 0;
  for (const StructureScore& c : candidates)
    latest = std::max(latest, structure_of(c, recording, inputs.window).first_transition());
  const DriftingChoice choice(recording, inputs.window, latest);
  DriftingGrid constant = coarse_drifting_grid();
  constant.q = constant.p0 = {0.0};
  constant.leak = {1.0};
  const auto found_one =
      std::find_if(candidates.begin(), candidates.end(), [](const StructureScore& c) { return c.chosen; });
  if (found_one == candidates.end()) return;
  found_one->drifting_score = choice.score(*found_one, coarse_drifting_grid());
  if (!(found_one->drifting_score >= choice.score(*found_one, constant) + least_drifting_gain)) return;
  for (StructureScore& c : candidates)
    if (&c != &*found_one) c.drifting_score = choice.score(c, coarse_drifting_grid());
  choose(found, std::move(candidates), recording, static_cast<double>(transitions));
}

}  // namespace modebank
