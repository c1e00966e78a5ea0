#pragma once

#include <optional>

#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "modebank/filter/screened_mode.hpp"

namespace modebank {

/// The prior with every mode's theta shrunk towards one motion. theta is normal about the theta that all modes of
/// `model` would share, fitted to these transitions. The prior has the information of `theta_transitions` additional
/// transitions. With 0 the prior does not change. With infinity all modes share theta and differ only in noise.
SwitchingPrior towards_one_motion(SwitchingPrior prior, const TrainingTransitions& transitions,
                                  SwitchingRegression model, double theta_transitions, const RefineTuning& tuning);

/// A model after shrinking modes towards one motion, and the amount of shrinking.
struct ShrunkModel {
  SwitchingRegression model;
  Shrinking shrinking;
};

/// Moves modes towards `theta` (p). Of all shares of the distance, the smallest is used at which the switching system
/// no longer grows in mean square. Moves the modes that are unstable by themselves; if that is not enough, all modes.
/// Empty if the system does not grow, or if one mode with this theta would grow, too.
std::optional<ShrunkModel> shrunk_to_stability(const LinearStructure& structure, const SwitchingRegression& model,
                                               const Eigen::VectorXd& theta, const RefineTuning& tuning);

}  // namespace modebank
