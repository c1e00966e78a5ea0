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

/// Settings for which `check` tries other values.
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
  bool one_motion = false;  ///< whether a bank of one mode judges the trial; otherwise the bank is learned as by `run`

  bool has(Change change) const { return std::find(changes.begin(), changes.end(), change) != changes.end(); }
};

/// Variance of a single state in the training runs while all inputs rest.
struct RestNoise {
  double duration_s = 0.0;  ///< 0: the state never rests, or there are several states
  double variance = 0.0;    ///< [state unit^2]
};
RestNoise rest_noise(const DataCheck& check);

/// A change of settings, compared with the settings accepted so far.
struct Trial {
  Change change = Change::rate;
  Settings from, to;
  Advice advice;  ///< computed for the data with the settings of the trial
  PairedGain
      gain;  ///< gain of `to` over `from` on training runs left out; for an accepted trial with all starts of `run`
  std::string unscored;  ///< reason of a missing gain; else empty
  bool accepted = false;
  RestNoise rest = {};  ///< basis of a stated measurement noise
};

struct Suggestions {
  Settings present, suggested;
  std::vector<Trial> trials;
  PairedGain together;     ///< of `suggested` over `present`
  Index runs = 0;          ///< number of training runs that were left out in turn
  bool whole_runs = true;  ///< false: there are too few runs, so parts of runs were left out
  std::string unscored;    ///< reason why no setting could be tried; else empty

  bool any() const;
};

/// Tries settings that suit the data, one after the other.
/// - Each trial starts from the accepted settings, on data with the accepted rate and lag.
/// - The order is: the rate with a suitable window length and step; the lag found by cross-validation; the window
///   length; the loss; the measurement noise by the state's variance at rest; many_restarts.
/// - A trial is accepted if its paired gain on training runs left out (left_out.hpp) exceeds one standard error and
///   0.001 nats per sample. It must gain first with refinement's starts from the mixture alone, then with all starts of
///   `run`.
/// - If all accepted trials together gain less, the last ones are withdrawn.
///
/// `check`: the check of the data with `options`.
Suggestions suggest(const ChainOptions& options, const DataCheck& check, const SuggestionScope& scope,
                    const Listener& listener);

/// Structure that `window.model` or lags of `auto` found, before suggestions are tried with this structure. Empty if no
/// key is `auto`.
std::optional<FoundStructure> find_structure(const ChainOptions& options, const Listener& listener);
/// The options with this structure, if there is one.
ChainOptions with_found(ChainOptions options, const std::optional<FoundStructure>& found);

}  // namespace modebank
