#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/cli/check/check.hpp"
#include "app/config/chain_options.hpp"
#include "filter/judge/score/paired_gain.hpp"
#include "ident/lag/structure.hpp"

namespace modebank {

/// Settings whose values `check` varies.
struct Settings {
  double rate_hz = 0.0;
  bool lag_auto = false;
  double lag_s = 0.0;
  Index window_length = 0, window_step = 1;
  Loss loss = Loss::huber;
  std::optional<double> measurement_variance = {};  ///< empty: learned
  int restarts = 0;
};
Settings settings_of(const ChainOptions& options);
ChainOptions with_settings(ChainOptions options, const Settings& settings);

/// The setting that a trial changes.
enum class Change { rate, lag, length, loss, noise, restarts };

/// Which settings to try, and how to judge them.
struct SuggestionScope {
  std::vector<Change> changes{Change::rate, Change::lag, Change::length, Change::loss};
  bool one_motion = false;  ///< whether a bank of one mode judges the trial; otherwise a bank is learned as in `run`

  bool has(Change change) const { return std::find(changes.begin(), changes.end(), change) != changes.end(); }
};

/// Variance of a single state in the training runs while all inputs rest.
struct RestNoise {
  double duration_s = 0.0;  ///< time at rest; 0 if the state never rests or if there are several states
  double variance = 0.0;    ///< [state unit^2]
};
RestNoise rest_noise(const DataCheck& check);

/// A change of settings. It is compared with the settings accepted so far.
struct Trial {
  Change change = Change::rate;
  Settings from, to;
  Advice advice;    ///< advice for the data with the settings of the trial
  PairedGain gain;  ///< gain of `to` over `from` on training runs left out; an accepted trial was computed with all
                    ///< starts of `run`
  std::string unscored;  ///< reason for a missing gain; empty if the gain is known
  bool accepted = false;
  RestNoise rest = {};  ///< source of the suggested measurement noise
};

struct Suggestions {
  Settings present, suggested;
  std::vector<Trial> trials;
  PairedGain together;     ///< gain of `suggested` over `present`
  Index runs = 0;          ///< number of training runs that were left out in turn
  bool whole_runs = true;  ///< false: there are too few runs, so parts of runs were left out
  std::string unscored;    ///< reason why no setting could be tried; empty if one could

  bool any() const;
};

/// Tries settings that suit the data, one after the other.
/// - Each trial starts from the accepted settings, on data with the accepted rate and lag.
/// - The order is: the rate with suitable windows, the lag by cross-validation, the window length, the loss, the
///   measurement noise, and many_restarts. The state's variance at rest serves as measurement noise.
/// - A trial is accepted if its paired gain on training runs left out (left_out.hpp) exceeds one standard error and
///   0.001 nats per sample. This must hold with refinement's starts from the mixture alone, and then with all starts of
///   `run`.
/// - If all accepted trials together gain less, the last ones are withdrawn.
///
/// `check`: result of check_data for `options`.
Suggestions suggest(const ChainOptions& options, const DataCheck& check, const SuggestionScope& scope,
                    const Listener& listener);

/// Finds the structure for `window.model = auto` or lags of `auto`. Suggestions are then tried with this structure.
/// Empty if no key is `auto`.
std::optional<FoundStructure> find_structure(const ChainOptions& options, const Listener& listener);
/// The options with this structure, if there is one.
ChainOptions with_found(ChainOptions options, const std::optional<FoundStructure>& found);

}  // namespace modebank
