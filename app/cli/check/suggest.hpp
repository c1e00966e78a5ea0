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

/// The settings that check may suggest others for.
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

/// What of the settings a trial changes.
enum class Change { rate, lag, length, loss, noise, restarts };

/// The settings that are tried, and how they are judged.
struct SuggestionScope {
  std::vector<Change> changes{Change::rate, Change::lag, Change::length, Change::loss};
  bool one_motion = false;  ///< by a bank of one mode, in place of a bank learned as `run` learns it

  bool has(Change change) const { return std::find(changes.begin(), changes.end(), change) != changes.end(); }
};

/// How a single state scatters in the training runs while all inputs rest.
struct RestNoise {
  double duration_s = 0.0;  ///< 0: it never rests, or there are several states
  double variance = 0.0;    ///< [state unit^2]
};
RestNoise rest_noise(const DataCheck& check);

/// Other settings, tried against those held until then.
struct Trial {
  Change change = Change::rate;
  Settings from, to;
  Advice advice;         ///< computed for the data as they would then be
  PairedGain gain;       ///< of `to` over `from` on training runs left out; learned as `run` learns if it is accepted
  std::string unscored;  ///< why there is no gain to tell of; empty: there is
  bool accepted = false;
  RestNoise rest = {};  ///< what a stated measurement noise rests on
};

struct Suggestions {
  Settings present, suggested;
  std::vector<Trial> trials;
  PairedGain together;     ///< of `suggested` over `present`
  Index runs = 0;          ///< training runs that were left out in turn
  bool whole_runs = true;  ///< false: too few of them, so stretches were left out
  std::string unscored;    ///< why nothing could be tried; empty: it could

  bool any() const;
};

/// Tries what the data speak for, one after the other, each on top of what was accepted before and computed for the
/// data at the rate, and with the lag, accepted before: the rate together with the window length that suits it, and
/// windows that start as often as before; the lag found by cross-validation; the window length; the loss; the
/// measurement noise by the state's scatter at rest; many_restarts. A trial is accepted if its paired gain on training
/// runs left out (left_out.hpp) exceeds one standard error and 0.001 nats per sample: first with refinement's starts
/// from the mixture alone, then with all that `run` has. Should all accepted ones together not gain so much, the last
/// are taken back. `check`: of the data as `options` say.
Suggestions suggest(const ChainOptions& options, const DataCheck& check, const SuggestionScope& scope,
                    const Listener& listener);

/// Lags that are to be found are found first: what is suggested is tried with them. Empty where none are.
std::optional<FoundStructure> find_structure(const ChainOptions& options, const Listener& listener);
/// The options with that structure, where there is one.
ChainOptions with_found(ChainOptions options, const std::optional<FoundStructure>& found);

}  // namespace modebank
