#pragma once

#include "ident/model/local_model.hpp"
#include "modebank/ident/options.hpp"

namespace modebank {

inline bool is_linear(const FitOptions& options) { return options.model == "linear" || options.model == "varx"; }

/// The linear model that the options name, for n states and m inputs; of a motion model the structure of its
/// linearisations, with an intercept.
inline LinearStructure linear_structure(Index states, Index inputs, const FitOptions& o) {
  if (o.model == "varx") return {states, inputs, o.intercept, o.state_lags, o.input_lags, o.input_delay};
  return {states, inputs, is_linear(o) ? o.intercept : true};
}

}  // namespace modebank
