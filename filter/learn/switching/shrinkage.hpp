#pragma once

#include <optional>

#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "modebank/filter/screened_mode.hpp"

namespace modebank {

/// The prior with every mode's theta drawn towards one motion: normal about the theta that all modes of `model` would
/// share, fitted to these transitions, with the information of `theta_transitions` more of them. None: the prior as it
/// is; without end: modes that differ in noise alone.
SwitchingPrior towards_one_motion(SwitchingPrior prior, const TrainingTransitions& transitions,
                                  SwitchingRegression model, double theta_transitions, const RefineTuning& tuning);

/// A model whose modes were drawn towards one motion, and how far.
struct ShrunkModel {
  SwitchingRegression model;
  Shrinking shrinking;
};

/// The model with modes drawn towards `theta` (p) by the least share of the way at which the switching system no longer
/// grows in mean square: the modes that are unstable by themselves, or all where that does not do. Empty where the
/// system does not grow (as it is, then), or where even one mode of that theta would.
std::optional<ShrunkModel> shrunk_to_stability(const LinearStructure& structure, const SwitchingRegression& model,
                                               const Eigen::VectorXd& theta, const RefineTuning& tuning);

}  // namespace modebank
