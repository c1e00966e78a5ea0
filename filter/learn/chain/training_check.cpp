#include "filter/learn/chain/training_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "ident/fit/fit_windows.hpp"
#include "ident/fit/unidentifiable_regressors.hpp"
#include "ident/model/parameter_labels.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

void refuse_constant_states(const Recording& recording) {
  for (Index i = 0; i < recording.state_count(); ++i) {
    double least = INFINITY, largest = -least;
    for (const Trajectory& run : recording.runs) {
      if (run.role != Role::train) continue;
      for (const double value : run.state.row(i)) {
        if (!std::isfinite(value)) continue;
        least = std::min(least, value);
        largest = std::max(largest, value);
      }
    }
    if (least != largest) continue;
    throw DataError(
        fmt::format("the state {0} is constant: {1:g} in every sample of the training runs; nothing "
                    "can be learned about it. Remove {0} from data.state, or train on runs in which it changes",
                    recording.states[static_cast<std::size_t>(i)].name, least));
  }
}

void refuse_unreached_horizons(const Recording& recording, const std::vector<Index>& horizons) {
  const bool held_out = recording.transitions(Role::test) > 0;
  const Trajectory* longest = nullptr;
  for (const Trajectory& run : recording.runs)
    if (run.role == (held_out ? Role::test : Role::train) && (!longest || run.samples() > longest->samples()))
      longest = &run;
  for (const Index horizon : horizons)
    if (longest && horizon > longest->transitions())
      throw DataError(fmt::format(
          "filter.horizon = {} is too long for the {} runs; the longest, {}, has {} samples: choose at "
          "most {}",
          horizon, held_out ? "held-out" : "training", longest->run, longest->samples(), longest->transitions()));
}

std::string unidentifiable_effects(const Recording& recording, const LinearStructure& structure) {
  const std::vector<Index> unidentifiable = unidentifiable_regressors(recording, structure);
  if (unidentifiable.empty()) return {};
  std::vector<std::string> labels = regressor_labels(structure, names_of(recording.states), names_of(recording.inputs));
  labels.emplace_back("the intercept");
  std::vector<std::string> named;
  for (const Index j : unidentifiable)
    named.push_back((j < structure.dimension() ? "the state " : "") + labels[static_cast<std::size_t>(j)]);
  return fmt::format(
      "not identifiable from the training runs: the effect of {}, which {} throughout; the other parameters keep their "
      "standard errors",
      fmt::join(named, ", "), named.size() == 1 ? "is zero" : "are zero or sums of multiples of each other");
}

std::string unidentifiable_effects(const Recording& recording, const FitOptions& options) {
  if (!is_linear(options)) return {};
  return unidentifiable_effects(recording, linear_structure(recording.state_count(), recording.input_count(), options));
}

}  // namespace modebank
