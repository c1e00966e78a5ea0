#pragma once

#include <string>
#include <vector>

#include "app/study/answers/study_table.hpp"
#include "filter/judge/scores.hpp"

/// Answers that are computed from a study's table. A *setting* is one combination of varied values; its repeats differ
/// only in the seed. Only finished trials count. This file neither reads files nor prints.
namespace modebank::app {

/// Mean of a score over all trials with one value of a varied key. A key has no effects if it has more than 30 values,
/// or if most of its values have a single setting while other keys vary, as in sampled plans.
/// Unless the plan is a full grid, the settings of other keys also affect this mean. `best` avoids this problem: it is
/// the score of the best setting with this value.
struct MainEffect {
  std::string key, value, score;
  int trials = 0;
  double mean = 0.0;
  double sd = 0.0;    ///< standard deviation between these trials; NaN for a single trial
  double best = 0.0;  ///< best mean over repeats among the settings with this value
};

/// Share of the variance of a score over the trials that the values of one key explain (eta squared, 0 to 1).
struct KeyInfluence {
  std::string key, score;
  double share = 0.0;
};

/// The setting with the best mean over its repeats.
struct BestSetting {
  std::string score;
  ScoreGoal goal;
  double value = 0.0;   ///< mean of the score over the repeats
  int repeats = 1;      ///< number of finished repeats
  std::size_t row = 0;  ///< row of the first finished repeat
};

struct Answers {
  std::string headline;  ///< score in the printed tables: the bank's held-out log score if it exists, else its training
                         ///< log score
  std::vector<MainEffect> main_effects;
  std::vector<KeyInfluence> influences;
  std::vector<BestSetting> best;
};

Answers answer(const StudyTable& table);

}  // namespace modebank::app
