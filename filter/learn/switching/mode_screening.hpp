#pragma once

#include <optional>

#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// A model that lost a mode, and which.
struct ScreenedModel {
  SwitchingRegression model;
  ScreenedMode mode;
};

/// The model without one mode that cannot serve, worst reason first; empty when all can. The last mode stays whatever
/// it is.
/// - "starved": fewer effective transitions than regressors + 1;
/// - "unstable": spectral radius of I + A above 1, the largest first, as long as the switching system is not
///   mean-square stable with it (a motion that never lasts may be unstable by itself);
/// - "duplicate" of another: pooling both modes' transitions (the moment-preserving merge of Runnalls 2007, IEEE Trans.
///   AES 43(3), its bound on the loss being the increase of 1/2 sum W log det Q) costs less than a likelihood-ratio
///   test at 5 % would notice. Its part in T goes to its twin.
/// `one_theta`: modes differ in Q alone, which is what the test then counts.
std::optional<ScreenedModel> without_worst_mode(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                                const SwitchingRegression& model, bool one_theta,
                                                const RefineTuning& tuning);

/// The model without the mode that it can best do without: the pair of modes that loses least by being pooled (as under
/// "duplicate" above, however much that is) is merged. Two modes at least.
SwitchingRegression with_closest_pair_merged(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                             const SwitchingRegression& model);

}  // namespace modebank
