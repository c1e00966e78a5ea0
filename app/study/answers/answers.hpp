#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/study/answers/study_table.hpp"
#include "filter/judge/score/scores.hpp"

/// What a study's table answers, beyond the table itself. A *setting* is one combination of varied values; its repeats
/// differ in seed alone. Only finished trials count. Nothing here reads a file or prints.
namespace modebank::app {

/// Mean of a score over all trials in which a varied key had one value (for keys with many numbers: a range of
/// values), whatever the others were. Confounded where the plan is not a full grid, and drawn down by settings that
/// nobody would choose: `best` is what the value can reach, and the best of all values is the best setting.
struct MainEffect {
  std::string key, value, score;
  int trials = 0;
  double mean = 0.0;
  double sd = 0.0;    ///< between those trials; NaN for one
  double best = 0.0;  ///< of the settings with that value, each by the mean over its repeats
};

/// How much of a score's variance over the trials the values of one key explain (eta squared, 0 to 1).
struct KeyInfluence {
  std::string key, score;
  double share = 0.0;
};

/// The setting whose mean over its repeats is best.
struct BestSetting {
  std::string score;
  ScoreGoal goal;
  double value = 0.0;   ///< mean over the repeats
  int repeats = 1;      ///< finished ones
  std::size_t row = 0;  ///< of its first finished repeat
};

/// A setting that no other beats in log score with as few modes.
struct ParetoSetting {
  double modes = 0.0;  ///< mean over the repeats, as the log score
  double log_score = 0.0;
  std::size_t row = 0;
};

/// How far repeats of one setting differ, against how far settings do.
struct RepeatSpread {
  std::string score;
  int settings = 0;         ///< with at least two finished repeats
  double sd = 0.0;          ///< root of the mean variance within a setting
  double largest_sd = 0.0;  ///< of any setting
  double between_sd = 0.0;  ///< of the settings' means; NaN for one
};

struct Answers {
  std::string headline;  ///< score the printed tables are about: the bank's log score, held-out if there is one
  std::vector<MainEffect> main_effects;
  std::vector<KeyInfluence> influences;
  std::vector<BestSetting> best;
  std::vector<ParetoSetting> pareto;  ///< by number of modes; empty when the table has no number of modes
  std::vector<RepeatSpread> spread;   ///< empty without repeats
};

Answers answer(const StudyTable& table);

}  // namespace modebank::app
