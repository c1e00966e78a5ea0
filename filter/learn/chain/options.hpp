#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/free_run.hpp"
#include "filter/learn/competitors/noise_by_input.hpp"
#include "ident/fit/options.hpp"
#include "ident/lag/armax.hpp"
#include "ident/lag/structure.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// Options for evaluating a filter. Options of the filter's steps are in FilterOptions.
struct ScoringOptions {
  static inline const std::vector<Eigen::Index> default_horizon{1, 10};
  std::vector<Eigen::Index> horizon = default_horizon;  ///< horizons in samples; the summary already has horizon 1
  FreeRunOptions free_run = {};                         ///< options of free runs, with the seed of the whole chain
  std::uint64_t seed = 1;  ///< seed for the transforms of quantised measurements; the seed of the whole chain
};

/// Which options of windows are derived from the data (ident/fit/window_length.hpp).
struct AutomaticWindows {
  bool length = false, step = false, intercept = false;

  bool any() const { return length || step || intercept; }
};

/// Lags and delays of the stages. A stage without an entry has those of the windows.
struct OtherLags {
  std::optional<StageLags> linear = {};      ///< for `baseline`, `noise_only` and the search for terms
  std::optional<StageLags> one_motion = {};  ///< for one motion with switching noise
  std::optional<StageLags> drifting = {};
  std::optional<ArmaxStructure> armax = {};  ///< for `baseline`, in place of `linear`
};

/// All options of learning from runs. `seed` is the only seed: it replaces those in `window` and `bank`.
struct LearningOptions {
  FitOptions window = {};
  ClusterOptions mixture = {};
  BankOptions bank = {};
  FilterOptions filter = {};
  ScoringOptions scoring = {};
  std::uint64_t seed = 1;
  SearchedLags searched_lags = {};          ///< which lags are chosen on runs that were left out; these replace the
                                            ///< lags in `window`
  AutomaticWindows automatic_windows = {};  ///< which values are derived from the data; these replace the values in
                                            ///< `window`
  std::string terms = "auto";               ///< terms of `nonlinear`: auto, none, or a list for
                                            ///< read_terms
  NoiseByInput noise_by_input = NoiseByInput::automatic;  ///< whether noise may depend on state and input
  OtherLags other_lags = {};
  bool competitors = true;  ///< if false, only the baseline is learned, and the bank is made from it
};

}  // namespace modebank
