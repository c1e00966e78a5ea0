#pragma once

#include <string>
#include <vector>

#include "app/text/mode_dynamics.hpp"
#include "io/archive/archive.hpp"

/// The bank's modes as people speak of them: how much they are used, how long they last, how fast they decay, where
/// they settle. app/text/summary_tables.hpp has their parameters.
namespace modebank::app {

/// "0.163 +- 0.004 s", "integrates", "unstable: grows e-fold in 2 s"; "... , period 0.5 s" of what oscillates.
std::string decay_words(const Decay& decay, const char* plus_minus = "+-");
/// What is left after a sample, of each eigenvalue or pair; the slowest first.
std::string per_sample_words(const std::vector<Decay>& decays);

/// One mode on the judged runs.
struct UsedMode {
  Index mode = 0;
  double use = 1.0;     ///< mean probability
  double stay_s = 0.0;  ///< mean stay; NaN where it was never entered
};
/// Most used first; where nothing was scored by weight, with the stays that the transition matrix says.
std::vector<UsedMode> used_modes(const Archive& archive);

/// Which gains there are: "wz per velL", row by row; each with its unit where they do not share one.
struct GainNames {
  std::vector<std::string> names;
  std::string unit;  ///< that all have; empty where none or several are known
};
GainNames gain_names(const Bank& bank, const std::vector<Channel>& states, const std::vector<Channel>& inputs);

/// A table of at most `rows` lines below its heading, `width` columns wide: the most used modes, how many others there
/// are; of each the slowest time constant and as many gains as there is room for.
struct ShortModes {
  std::string text;
  Index gains_left_out = 0;
};
ShortModes short_modes(const Archive& archive, Index rows, int width);
/// All modes with all of it, for `show`. 0: no limit.
std::string modes_in_words(const Archive& archive, int width = 0);

}  // namespace modebank::app
