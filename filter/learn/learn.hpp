#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/learn/tuning.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "mixture/select.hpp"
#include "modebank/learn/options.hpp"

namespace modebank {

/// One Kalman filter on the global model with maximum-likelihood Q and R. Also contains the result of that search.
struct Baseline {
  Bank bank;                    ///< K = 1
  double log_likelihood = 0.0;  ///< log-likelihood of the training runs, without each run's first sample
  bool converged = false;
  bool at_bound = false;  ///< whether R is at its lower bound (1e-8 of the residual variance), or is 0 because there
                          ///< are many lags
};

/// theta is the global least-squares estimate; Q (full) and R (diagonal) maximise the exact Gaussian likelihood. For
/// rounded states all three do, with R of at least the variance of rounding. With more than most_lags_beside_R lags, R
/// is 0 and Q is the residual covariance.
Baseline learn_baseline(const Recording& recording, const GlobalModel& global, const LinearStructure& structure);

/// The competitor with switching noise only. It has one theta (Huber's estimate), eight noise scales in geometric
/// steps, and `stay` chosen on the training runs. If states are rounded, theta and the scales then maximise the
/// filter's likelihood, whose R has the rounding. `factor`: applies to all scales.
Bank learn_noise_only(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                      const NoiseFactor& factor = {});

/// The same competitor with theta, C and R of a single filter whose R is known beside Q: eight levels of its Q, from a
/// quarter to 32 times. (Residuals of exact states would count R twice.)
Bank noise_levels_of(const Bank& single, const Recording& recording);

/// learn_noise_only with another number of noise scales.
Bank learn_noise_levels(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                        Eigen::Index levels, const NoiseFactor& factor = {});

/// The competitor with one motion, learned like the bank. Expectation-maximisation with one theta shared by all modes
/// starts from `most_levels` noise scales and fewer, down to one. Its own cross-validation chooses among them
/// (refine_bank), with measurement noise as in `options`. One more start has the noises and transitions of `rival`, the
/// bank that it competes with. `global`: the global model in linear form.
Refinement learn_one_motion(const Recording& recording, const WindowFits& fits, const GlobalModel& global,
                            const Bank& rival, const Eigen::MatrixXd& R, Eigen::Index most_levels,
                            const BankOptions& options);

/// The competitor with one nonlinear motion. theta of linear regressors and terms comes from expectation-maximisation
/// with one theta shared by all noise levels, as in learn_one_motion. The search starts from up to four levels and one
/// wide level. The terms of each transition are then known inputs, because states count as measured exactly (R is
/// negligible). `em`: prior, iterations and folds of the search. `structure`: with the lags of the terms.
Bank learn_nonlinear(const Recording& recording, const LinearStructure& structure, const MotionTerms& terms,
                     const RefineOptions& em);

/// Starting banks with one theta. The first has `most` noise levels, the next three quarters of that, and so on.
std::vector<Bank> level_starts(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                               Eigen::Index most, double kept, const NoiseFactor& factor = {});

/// Converts clustered windows into a bank (method: section 4). `R` is used unless options.measurement_variance is set.
/// `motion`: motion model of the windows, null for linear models. Its modes are linearised at their mean state and
/// input. If every component is screened out, the bank has one mode, merged from all components.
Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion = nullptr);

/// Replaces Refine::automatic by em or none (see Refine); other values do not change. `linear`: whether the model of
/// the windows is linear.
Refine refinement_asked(const BankOptions& options, bool linear);

/// Calls learn_refined_bank or learn_bank, as refinement_asked decides. Only learn_refined_bank needs `filter`. Throws
/// std::invalid_argument for refinement of a motion model.
Refinement learn_as_asked(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                          const BankOptions& options, const Eigen::MatrixXd& R,
                          const std::optional<FilterOptions>& filter, const MotionModel* motion);

/// Calls learn_bank, then refine_bank. Starts are the mixture's bank and smaller banks. Smaller banks come from merging
/// the closest components (merge_components), each time to three quarters of the modes, down to one. One mode wins if
/// more modes do not gain on training runs that were left out, for example with little data. The mixture's own bank is
/// `start` of the result.
Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter);

}  // namespace modebank
