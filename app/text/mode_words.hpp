#pragma once

#include <string>
#include <vector>

#include "app/text/mode_dynamics.hpp"
#include "io/archive/archive.hpp"

/// The bank's modes in words: use, stay, time constants, gains. app/text/mode_tables.hpp makes tables of these words.
/// app/text/summary_tables.hpp prints the parameters of the modes.
namespace modebank::app {

/// Text such as "0.163 +- 0.004 s", "integrates" or "unstable, held by the loop". If, within the standard error, the
/// mode may never die out, the text is "over 3 s". For a mode that oscillates, it ends in ", period 0.5 s".
/// `unit`: that of times.
std::string decay_words(const Decay& decay, const char* plus_minus = "+-", const std::string& unit = "s");
/// Factor per sample for each eigenvalue or pair, the slowest first.
std::string per_sample_words(const std::vector<Decay>& decays);

/// Use and stay of one mode on the judged runs.
struct UsedMode {
  Index mode = 0;
  double use = 1.0;  ///< mean probability
  /// Mean stay by the transition matrix; NaN if the mode was never entered. Gaps that cut runs do not shorten it. If it
  /// exceeds the longest run, it is that run's length and `at_least` is true.
  double stay_s = 0.0;
  bool at_least = false;
};
/// Text such as "6.61 s" or "over 60 s"; "-" if the mode was never entered.
std::string stay_words(const UsedMode& mode, const std::string& unit = "s");
/// The modes of the bank, the most used first. If no run was scored, as for a bank without scores.
std::vector<UsedMode> used_modes(const Archive& archive);
/// Without scores the use is the mode's weight, and the stay follows from T.
std::vector<UsedMode> used_modes(const Bank& bank);

/// Text for a parameter that the training runs do not determine. Example: an input is always zero, or one input is a
/// sum of others.
inline constexpr const char* not_identifiable = "not identifiable";
/// For each parameter of a linear model, whether it is unidentifiable. Such a parameter has no standard error in the
/// global model.
std::vector<bool> unidentifiable_parameters(const Archive& archive, const LinearStructure& structure);
/// Whether the decays are unidentifiable, because the effect of some state is unidentifiable. The gains are then also
/// unidentifiable.
bool unidentifiable_decays(const Archive& archive, const LinearStructure& structure);
/// For each gain (states x inputs, row by row), whether some effect of the input on the state is unidentifiable.
std::vector<bool> unidentifiable_gains(const Archive& archive, const LinearStructure& structure);

/// A name for a heading or a cell. It has at most 16 columns; a longer name is cut and ends in "..".
std::string shortened(const std::string& name);

/// Names of the gains, such as "wz per velL", row by row. Each name contains a unit if the units differ.
struct GainNames {
  std::vector<std::string> names;
  std::string unit;  ///< unit of all gains; empty if the gains have no unit or different units
};
GainNames gain_names(const Bank& bank, const std::vector<Channel>& states, const std::vector<Channel>& inputs);

}  // namespace modebank::app
