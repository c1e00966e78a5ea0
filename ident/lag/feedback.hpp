#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Largest |t| of innovations in regressions of the inputs on their own lags.
struct InputFeedback {
  double past_t = 0.0;  ///< largest |t| of the innovation one sample earlier; it shows that the inputs react to the
                        ///< states
  double same_sample_t = 0.0;  ///< largest |t| of the innovation of the same sample; it can come from a reaction within
                               ///< the sample or from an effect without delay
};

/// Computes InputFeedback. Innovations come from a least-squares model of three state lags and the earlier inputs. The
/// larger of two standard errors is used: that for constant noise, and White's for varying noise. NaN without inputs,
/// or if the number of samples is less than twice the number of coefficients.
InputFeedback input_feedback(const Recording& recording);

}  // namespace modebank
