#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Largest |t| of innovations in regressions of the inputs on their own lags.
struct InputFeedback {
  double past_t = 0.0;         ///< of the innovation one sample earlier: the inputs react to the states
  double same_sample_t = 0.0;  ///< of the same sample's innovation: a reaction within the sample or an effect without
                               ///< delay, which look alike
};

/// Computes InputFeedback. Innovations come from a least-squares model of three state lags and the earlier inputs. The
/// larger of two standard errors counts: for constant noise, and White's for varying noise. NaN without inputs, or with
/// fewer than twice as many samples as coefficients.
InputFeedback input_feedback(const Recording& recording);

}  // namespace modebank
