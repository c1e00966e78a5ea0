#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/learn/tuning.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "mixture/select.hpp"
#include "modebank/learn/options.hpp"

namespace modebank {

/// One Kalman filter on the global model, Q and R by maximum likelihood, and how that ended.
struct Baseline {
  Bank bank;                    ///< K = 1
  double log_likelihood = 0.0;  ///< of the training runs, from each run's second sample
  bool converged = false;
  bool at_bound = false;  ///< R stopped where it adds 1e-8 to the residual variance, or is 0 beside many lags
};

/// theta fixed at the global least squares; Q (full) and R (diagonal) maximise the exact Gaussian likelihood. Of
/// rounded states all three maximise the likelihood of their intervals. Beside more than most_lags_beside_R lags R is 0
/// and Q the residual covariance.
Baseline learn_baseline(const Recording& recording, const GlobalModel& global, const LinearStructure& structure);

/// The competitor that switches noise only: one Huber theta, eight log-spaced noise scales, `stay` chosen on the
/// training runs. Of rounded states theta and the scales go on from there to where their intervals are most likely.
/// `factor`: on all scales.
Bank learn_noise_only(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                      const NoiseFactor& factor = {});

/// The same with another number of noise scales.
Bank learn_noise_levels(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                        Eigen::Index levels, const NoiseFactor& factor = {});

/// How the noise scale of a competitor moves in an adaptive filter: what makes the training runs most likely of the
/// ways that a bank's cross-validation tries. A competitor has so few parameters that nothing need be left out for
/// that.
NoiseAdaptation most_likely_adaptation(const Bank& bank, const Recording& recording, const FilterOptions& filter,
                                       const RefineTuning& tuning);

/// The competitor that knows one motion and is learned as the bank is: expectation-maximisation with one theta that all
/// modes share, from `most_levels` noise scales and fewer down to one, chosen by its own cross-validation
/// (refine_bank), and with measurement noise as `options` say; one more start has the noises and the chain of
/// `rival`, the bank that it is asked to describe as well. `global`: of linear terms. `filter`: that will run it.
Refinement learn_one_motion(const Recording& recording, const WindowFits& fits, const GlobalModel& global,
                            const Bank& rival, const Eigen::MatrixXd& R, Eigen::Index most_levels,
                            const BankOptions& options, const FilterOptions& filter);

/// The competitor whose one motion bends: theta of linear regressors and terms by expectation-maximisation with one
/// theta that all noise levels share, as learn_one_motion's, from up to four levels and with a wide one more. Each
/// transition's terms are known inputs then, since states count as measured exactly: R is as good as none. `em`: its
/// prior, iterations and folds. `structure`: with the lags that the terms want. `filter`: that will run it.
Bank learn_nonlinear(const Recording& recording, const LinearStructure& structure, const MotionTerms& terms,
                     const RefineOptions& em, const FilterOptions& filter);

/// Banks of one theta with `most` noise levels, and with three quarters as many again and again: where such a learning
/// starts.
std::vector<Bank> level_starts(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                               Eigen::Index most, double kept, const NoiseFactor& factor = {});

/// Turns clustered windows into a bank (method: section 4). `R` is used unless options.measurement_variance is set.
/// `motion`: the model that the windows were fitted with, null for linear ones; its modes are linearised at their mean
/// state and input. Where every component is screened the bank has one mode, of all of them merged; throws DataError
/// when that one is screened too.
Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion = nullptr);

/// Refine::automatic as em or none (Refine says when), other values as they are. `linear`: not a motion model's
/// windows.
Refine refinement_asked(const BankOptions& options, bool linear);

/// learn_refined_bank or learn_bank alone, as refinement_asked says; only the first needs `filter`. It knows no motion
/// models: throws std::invalid_argument where it is asked for with one.
Refinement learn_as_asked(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                          const BankOptions& options, const Eigen::MatrixXd& R,
                          const std::optional<FilterOptions>& filter, const MotionModel* motion);

/// learn_bank, then refine_bank from it and from what is left of the mixture when its closest components are merged
/// (merge_components) down to three quarters of the modes, again and again until there is one: where more modes do not
/// pay on training runs left out, as with little data, one mode wins. The mixture's own bank is `start` of the result.
Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter);

}  // namespace modebank
