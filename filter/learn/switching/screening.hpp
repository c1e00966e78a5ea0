#pragma once

#include <optional>

#include "filter/learn/switching/regression.hpp"
#include "filter/learn/tuning.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Growth per step of the second moment of x[k+1] = F_j x[k] under switching by T. It is the spectral radius of the
/// operator X_j -> sum_i T_ij F_i X_i F_i' (Costa, Fragoso & Marques 2005, "Discrete-Time Markov Jump Linear Systems",
/// chapter 3). Below 1 the system is mean-square stable. The accuracy is 1e-8. For a defective operator (double
/// integrators) it is about eps^(1 / order of the defect), with the machine precision eps. Infinite if a mode is not
/// finite.
double mean_square_growth(const LinearStructure& structure, const SwitchingRegression& model);

/// A model after the removal of a mode, and the removed mode.
struct ScreenedModel {
  SwitchingRegression model;
  ScreenedMode mode;
};

/// The model without its worst unusable mode; empty if all modes are usable. The last mode always stays. Reasons, worst
/// first:
/// - "starved": the mode has fewer effective transitions than regressors + 1.
/// - "unstable": the spectral radius of I + A is above 1 and the switching system with the mode is not mean-square
///   stable. The largest radius comes first. (A mode that never lasts may be unstable by itself.)
/// - "duplicate" of another mode: pooling the transitions of both costs less than a likelihood-ratio test at 5 %
///   would detect. Pooling is the moment-preserving merge of Runnalls 2007, IEEE Trans. AES 43(3). The cost is the
///   bound of Runnalls: the increase of 1/2 sum W log det Q. In T, the other mode receives the transitions of the
///   removed mode.
/// `one_theta`: modes differ only in Q, and the test counts only the parameters of Q.
std::optional<ScreenedModel> without_worst_mode(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                                const SwitchingRegression& model, bool one_theta);

/// The model with its closest pair of modes merged, whatever the cost. The closest pair is the one whose pooling costs
/// least (see "duplicate" above). Requires at least two modes.
SwitchingRegression with_closest_pair_merged(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                             const SwitchingRegression& model);

}  // namespace modebank
