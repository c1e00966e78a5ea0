#pragma once

#include <string>
#include <vector>

#include "app/text/mode_dynamics.hpp"
#include "io/archive/archive.hpp"

/// The bank's modes as people speak of them: how much they are used, how long they last, how fast they decay, where
/// they settle. app/text/mode_tables.hpp has tables of them, app/text/summary_tables.hpp their parameters.
namespace modebank::app {

/// "0.163 +- 0.004 s", "integrates", "unstable: grows e-fold in 2 s", "over 3 s" where the standard error reaches a
/// mode that never dies out; "... , period 0.5 s" of what oscillates.
std::string decay_words(const Decay& decay, const char* plus_minus = "+-");
/// What is left after a sample, of each eigenvalue or pair; the slowest first.
std::string per_sample_words(const std::vector<Decay>& decays);

/// One mode on the judged runs.
struct UsedMode {
  Index mode = 0;
  double use = 1.0;  ///< mean probability
  /// Mean stay; NaN where it was never entered. By the transition matrix: where gaps cut runs, stays look shorter.
  /// Where that has seen no end of it in the longest run, the length of that run, which the stay is at least.
  double stay_s = 0.0;
  bool at_least = false;
};
/// "6.61 s", "over 60 s"; "-" where it was never entered.
std::string stay_words(const UsedMode& mode);
/// Most used first; where nothing was scored by weight.
std::vector<UsedMode> used_modes(const Archive& archive);

/// Said of what the training runs leave open: an input that is always zero, inputs of which one is a sum of others.
inline constexpr const char* not_identifiable = "not identifiable";
/// Per parameter of a linear model of that structure whether they do: it has no standard error in the global model.
std::vector<bool> unidentifiable_parameters(const Archive& archive, const LinearStructure& structure);
/// Whether how fast a mode decays is open: the effect of a state is. Every gain rests on it.
bool unidentifiable_decays(const Archive& archive, const LinearStructure& structure);
/// The same per gain (states x inputs, a state's in a row): some effect of the input on the state is open.
std::vector<bool> unidentifiable_gains(const Archive& archive, const LinearStructure& structure);

/// A name for a heading or a cell: at most 16 columns, ".." in place of the rest.
std::string shortened(const std::string& name);

/// Which gains there are: "wz per velL", row by row; each with its unit where they do not share one.
struct GainNames {
  std::vector<std::string> names;
  std::string unit;  ///< that all have; empty where none or several are known
};
GainNames gain_names(const Bank& bank, const std::vector<Channel>& states, const std::vector<Channel>& inputs);

/// How many modes or families stand in a table one by one: the most used, at most eight, none below 1 % (but at least
/// one). The rest are "others".
/// `use`: of each, the most used first.
Index told_of(const std::vector<double>& use);

}  // namespace modebank::app
