#include "app/study/run/trial_order.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "app/chain/stage_key.hpp"

namespace modebank::app {
namespace {

/// Stages by which trials are grouped, the coarsest first.
constexpr std::array<Stage, 3> grouped{Stage::windows, Stage::mixture, Stage::bank};

/// Gives texts numbers in the order of their first appearance.
class Numbering {
 public:
  std::size_t of(const std::string& text) { return numbers_.try_emplace(text, numbers_.size()).first->second; }

 private:
  std::map<std::string, std::size_t> numbers_;
};

struct PlacedTrial {
  std::array<std::size_t, 3> stages;  ///< numbers of the row's windows, mixture and bank
  std::size_t row;
};

std::vector<PlacedTrial> place_trials(const Config& study, const StudyPlan& plan) {
  std::array<Numbering, 3> numbers;
  std::vector<PlacedTrial> trials;
  for (std::size_t row = 0; row < plan.table.rows.size(); ++row) {
    if (plan.table.rows[row].status == TrialStatus::dropped) continue;
    const Config config = trial_config(study, plan.table.varied_keys, plan.table.rows[row]);
    const StageKeys keys = stage_keys(chain_inputs(chain_options(config)), "");
    PlacedTrial trial{{}, row};
    for (std::size_t i = 0; i < grouped.size(); ++i) trial.stages[i] = numbers[i].of(keys[index_of(grouped[i])]);
    trials.push_back(trial);
  }
  return trials;
}

}  // namespace

TrialGroups group_trials(const Config& study, const StudyPlan& plan) {
  std::vector<PlacedTrial> trials = place_trials(study, plan);
  std::stable_sort(trials.begin(), trials.end(),
                   [](const PlacedTrial& a, const PlacedTrial& b) { return a.stages < b.stages; });
  TrialGroups groups;
  const PlacedTrial* last = nullptr;
  for (const PlacedTrial& trial : trials) {
    if (!last || last->stages[1] != trial.stages[1]) groups.emplace_back();
    groups.back().push_back(trial.row);
    last = &trial;
  }
  return groups;
}

}  // namespace modebank::app
