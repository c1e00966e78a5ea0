#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Largest |t| of innovations in regressions of the inputs on their own lags.
struct InputFeedback {
  double past_t = 0.0;  ///< largest |t| of the innovation one sample earlier; large values show that the inputs react
                        ///< to the states
  double same_sample_t = 0.0;  ///< largest |t| of the innovation of the same sample; large values can come from a
                               ///< reaction within the sample or from an effect without delay
};

/// Computes InputFeedback. Innovations come from a least-squares model of three state lags and the earlier inputs. Two
/// standard errors are computed, for constant noise and White's for varying noise; the larger one is used. NaN without
/// inputs, or if the number of samples is less than twice the number of coefficients.
InputFeedback input_feedback(const Recording& recording);

}  // namespace modebank
