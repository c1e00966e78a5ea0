#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/free_run.hpp"
#include "filter/learn/competitors/noise_by_input.hpp"
#include "filter/learn/learn.hpp"
#include "ident/fit/options.hpp"
#include "ident/lag/structure.hpp"
#include "io/import/options.hpp"
#include "mixture/select.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// What is found out about a filter, beside how it steps.
struct ScoringOptions {
  static inline const std::vector<Index> default_horizon{1, 10};
  std::vector<Index> horizon = default_horizon;  ///< samples ahead; 1 alone is what the summary scores anyway
  bool smooth = true;                            ///< smoothed states and the most probable sequence of modes, too
  FreeRunOptions free_run = {};                  ///< its seed is the chain's
  std::uint64_t seed = 1;                        ///< of the transforms of quantised measurements; the chain's
};

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

/// Everything that decides the numbers of a chain beside its data. `seed` is the one seed: it takes the place of those
/// in `window` and `bank`.
struct ChainOptions {
  DataOptions data;
  FitOptions window;
  ClusterOptions mixture;
  std::string mixture_start;  ///< archive whose mixture is a start; empty: mixture.selection.em.start alone
  BankOptions bank;
  FilterOptions filter;
  ScoringOptions scoring;
  std::uint64_t seed = 1;
  SearchedLags searched_lags = {};                        ///< that are found by runs left out, whatever `window` has
  AutomaticWindows automatic_windows = {};                ///< whatever `window` has
  std::vector<std::string> mode_names = {};               ///< of the bank; they change no number
  std::string terms = "auto";                             ///< of nonlinear: auto, none, or a list that read_terms takes
  NoiseByInput noise_by_input = NoiseByInput::automatic;  ///< whether noise may follow state and input
  OtherLags other_lags = {};
};

}  // namespace modebank
