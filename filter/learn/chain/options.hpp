#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/score/scoring_options.hpp"
#include "filter/learn/competitors/noise_by_input.hpp"
#include "ident/fit/options.hpp"
#include "ident/lag/structure.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// Which numbers of windows are found from the data (ident/fit/window_length.hpp).
struct AutomaticWindows {
  bool length = false, step = false;

  bool any() const { return length || step; }
};

/// Lags and delay of stages that have others than the windows; empty: the same.
struct OtherLags {
  std::optional<Lags> linear = {};      ///< baseline, noise_only, and where terms are looked for
  std::optional<Lags> one_motion = {};  ///< one motion whose noise switches
  std::optional<Lags> drifting = {};
};

/// Everything that decides what is learned from runs. `seed` is the one seed: it takes the place of those in `window`
/// and `bank`.
struct LearningOptions {
  FitOptions window = {};
  ClusterOptions mixture = {};
  BankOptions bank = {};
  FilterOptions filter = {};
  ScoringOptions scoring = {};
  std::uint64_t seed = 1;
  SearchedLags searched_lags = {};                        ///< that are found by runs left out, whatever `window` has
  AutomaticWindows automatic_windows = {};                ///< whatever `window` has
  std::string terms = "auto";                             ///< of nonlinear: auto, none, or a list that read_terms takes
  NoiseByInput noise_by_input = NoiseByInput::automatic;  ///< whether noise may follow state and input
  OtherLags other_lags = {};
  bool competitors = true;  ///< false: none is learned but the baseline, which the bank starts from
};

}  // namespace modebank
