#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/learn.hpp"
#include "ident/fit/options.hpp"
#include "io/import/options.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Which cloud of windows is clustered, and how.
struct ClusterOptions {
  SelectionOptions selection;
  FeatureSet features = FeatureSet::parameters_and_noise;
  WindowChoice windows = WindowChoice::automatic;
  StraddlingWindows straddling = StraddlingWindows::leave_out;
  bool error_aware = false;
  std::string start_file;  ///< archive whose mixture is a start; empty: selection.em.start alone
};

/// What is found out about a filter, beside how it steps.
struct ScoringOptions {
  std::vector<Index> horizon{1};  ///< samples ahead; 1 alone is what the summary scores anyway
  bool smooth = true;             ///< smoothed states and the most probable sequence of modes, too
};

/// Everything that decides the numbers of a chain beside its data. `seed` is the one seed: it takes the place of those
/// in `window` and `bank`.
struct ChainOptions {
  DataOptions data;
  FitOptions window;
  ClusterOptions mixture;
  BankOptions bank;
  FilterOptions filter;
  ScoringOptions scoring;
  std::uint64_t seed = 1;
};

}  // namespace modebank
