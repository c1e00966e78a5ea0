#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/study/answers/study_table.hpp"
#include "filter/judge/score/scores.hpp"

/// Answers that follow from a study's table. A *setting* is one combination of varied values; its repeats differ in
/// seed alone. Only finished trials count. This file neither reads files nor prints.
namespace modebank::app {

/// Mean of a score over all trials with one value of a varied key (for keys with many numbers: a range of values).
/// Unless the plan is a full grid, other keys confound this mean, and their bad settings lower it. `best` does not have
/// this problem: it is the score of the best setting with this value.
struct MainEffect {
  std::string key, value, score;
  int trials = 0;
  double mean = 0.0;
  double sd = 0.0;    ///< standard deviation between those trials; NaN for one
  double best = 0.0;  ///< best mean over repeats among the settings with this value
};

/// Share of a score's variance over the trials that the values of one key explain (eta squared, 0 to 1).
struct KeyInfluence {
  std::string key, score;
  double share = 0.0;
};

/// The setting with the best mean over its repeats.
struct BestSetting {
  std::string score;
  ScoreGoal goal;
  double value = 0.0;   ///< mean over the repeats
  int repeats = 1;      ///< number of finished repeats
  std::size_t row = 0;  ///< row of its first finished repeat
};

/// A setting for which no other setting with as few or fewer modes has a better log score.
struct ParetoSetting {
  double modes = 0.0;  ///< mean over the repeats, as the log score is
  double log_score = 0.0;
  std::size_t row = 0;
};

/// Standard deviation between repeats of one setting, and between settings.
struct RepeatSpread {
  std::string score;
  int settings = 0;         ///< number of settings with at least two finished repeats
  double sd = 0.0;          ///< root of the mean variance within a setting
  double largest_sd = 0.0;  ///< largest within one setting
  double between_sd = 0.0;  ///< between the settings' means; NaN for one setting
};

struct Answers {
  std::string headline;  ///< score of the printed tables: the bank's log score, held-out if there is one
  std::vector<MainEffect> main_effects;
  std::vector<KeyInfluence> influences;
  std::vector<BestSetting> best;
  std::vector<ParetoSetting> pareto;  ///< by number of modes; empty when the table has no column of modes
  std::vector<RepeatSpread> spread;   ///< empty without repeats
};

Answers answer(const StudyTable& table);

}  // namespace modebank::app
