#pragma once

#include "ident/model/local_model.hpp"
#include "modebank/ident/options.hpp"

namespace modebank {

/// Whether the options give lags or a delay, which `linear` does not support.
inline bool has_lags(const FitOptions& o) { return o.state_lags != 1 || o.input_lags != 1 || o.input_delay != 1; }

inline bool is_linear(const FitOptions& options) { return options.model == "linear" || options.model == "varx"; }

/// The linear model that the options describe, for n states and m inputs. For a motion model it is the structure of its
/// linearisations, with an intercept.
inline LinearStructure linear_structure(Index states, Index inputs, const FitOptions& o) {
  const InputDelays delay = inputs > 0 ? o.input_delay : InputDelays();
  if (o.model == "varx") return {states, inputs, o.intercept, o.state_lags, o.input_lags, delay, o.centre};
  return {states, inputs, is_linear(o) ? o.intercept : true, 1, 1, 1, o.centre};
}

}  // namespace modebank
