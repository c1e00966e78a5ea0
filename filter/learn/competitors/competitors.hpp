#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/terms.hpp"
#include "modebank/learn/options.hpp"

/// The filters that a bank competes with (method: section 6).
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

/// The same competitor beside a baseline. If that is the linear stage's, whose R is known beside Q, and without a
/// factor: its theta, C and R with eight levels of its Q, from a quarter to 32 times (residuals of exact states
/// count R twice), if they are more likely on the training runs than learn_noise_only.
Bank noise_only_beside(const Bank& baseline, bool of_linear_stage, const Recording& recording,
                       const LinearStructure& structure, const NoiseFactor& factor);

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

/// The most likely factor on the noise of one motion (method: section 2a, item 5). First theta is Huber's estimate for
/// the structure and the terms. Then the factor maximises the likelihood of Student t residuals with scale exp(g'z /
/// 2). z holds logarithms of the newest states, the newest inputs, their changes (if the structure has the previous
/// input), and each state's forecast contribution from inputs. Empty if all residuals are zero. Throws DataError
/// without usable transitions.
NoiseFactor fit_noise_factor(const Recording& recording, const LinearStructure& structure,
                             const MotionTerms& terms = {});

/// The factor, if training runs that were left out gain by it.
struct FoundNoiseFactor {
  NoiseFactor factor;                    ///< empty: rejected
  double gain = not_a_number;            ///< gain on left-out runs [nats/sample]. If the factor was rejected without
                                         ///< cross-validation, gain on all runs
  double standard_error = not_a_number;  ///< standard error of the gain over the left-out runs; NaN if no run was left
                                         ///< out
};

/// Compares one motion whose noise switches between four levels with and without the factor. The factor is accepted if
/// the rule for additions accepts it on runs that were left out (left_out/rule.hpp). Rounded samples are
/// not tested. Learns from at most 20,000 transitions drawn by the seed.
FoundNoiseFactor find_noise_factor(const Recording& recording, const LinearStructure& structure, Eigen::Index folds,
                                   std::uint64_t seed);

/// The settings of a drifting model to choose from (method: section 6). Of settings with equal scores, the earlier one
/// is preferred. q, p0 and floor ascend, leak descends.
struct DriftingGrid {
  std::vector<double> q{0.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
  std::vector<double> p0{0.0, 1e-2, 1e-1, 1.0, 10.0};
  std::vector<double> leak{1.0, 0.97, 0.9};
  std::vector<double> lam{0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.92, 0.96};
  std::vector<double> nu{0.0, 3.0, 5.0, 8.0, 15.0};
  std::vector<double> floor{1e-6, 1e-5, 1e-4, 1e-3};  ///< as a share of the variance of the training residuals

  /// Sizes of the grid in the order q, p0, leak, lam, nu, floor; the last index changes fastest.
  std::array<Eigen::Index, 6> sizes() const {
    return {std::ssize(q), std::ssize(p0), std::ssize(leak), std::ssize(lam), std::ssize(nu), std::ssize(floor)};
  }
  /// The indices of a grid point.
  std::array<Eigen::Index, 6> point(Eigen::Index index) const;
};

/// The log score of the training runs at every point of the grid [nats/sample].
struct DriftingScores {
  Eigen::VectorXd log_score;
  Eigen::Index samples = 0;  ///< scored samples, all of equal weight

  /// n x (q, p0, leak): mean of e^2 / (1 + h'Ph), divided by v0.
  Eigen::MatrixXd error_ratio = {};
  /// The grid point with the highest score; the first one if several are equal.
  Eigen::Index best() const;
};

/// Scores the grid for the competitor `drifting`, a bank of one mode that drifts, with running noise. `start`: a bank
/// with theta, scale, Q and choice of drifting coefficients from the training runs; its other settings are ignored.
/// Each (q, p0, leak) has one recursion of the coefficients. All running variances follow from this recursion, and all
/// densities follow from the variances. Throws std::invalid_argument for an empty grid, and DataError if no sample can
/// be scored.
DriftingScores score_drifting_grid(const Bank& start, const Recording& recording, const DriftingGrid& grid);

/// Learns the competitor `drifting`. `global`: least squares of this structure on the training runs. The settings are
/// those of the grid with the best log score of the training runs one sample ahead. Each of `horizons` from 2 on has a
/// factor on the variance. Of 2^(-4), 2^(-3.75), ..., 2^8, it is the factor that makes the training errors most likely.
/// All samples have equal weight. If one common factor drifts, v0 is the variance of the drifting model's own errors.
/// Errors of a model with constant coefficients would include the drift.
Bank learn_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                    const std::vector<Eigen::Index>& horizons, const DriftingGrid& grid = {},
                    Wandering wandering = Wandering::all);

/// The model with noise levels: the variances of the modes of `one_motion`, which differ in noise alone, and their
/// transition matrix. All other settings are chosen again: two climbs, setting by setting, to the best log score of the
/// training runs one sample ahead. `drifting` itself if it scores as well there, or if `one_motion` has one level.
Bank with_noise_levels(const Bank& drifting, const Bank& one_motion, const Recording& recording,
                       const std::vector<Eigen::Index>& horizons);

/// A model with the settings of `like`. theta0 and the variances come from these training runs.
Bank relearn_drifting(const Bank& like, const Recording& recording, const GlobalModel& global);

/// A grid with fewer settings. It is used to compare models; forecasts use the full grid.
DriftingGrid coarse_drifting_grid();
/// Causal log score of the training transitions from `latest` on. The score is that of the drifting model with this
/// structure, learned from these transitions. `latest` is the first transition that the model with the longest memory
/// predicts. Minus infinity if the model cannot be learned.
double drifting_training_score(const Recording& recording, Eigen::Index latest, const LinearStructure& structure,
                               const DriftingGrid& grid, Wandering wandering = Wandering::all);

/// Like learn_drifting, but also chooses which coefficients drift. Candidates are: all coefficients of `structure`; its
/// constant (added if absent); one factor on its input coefficients; or each of these with one lag. The causal score of
/// at most 20,000 transitions decides, with settings of the coarse grid. All coefficients of `structure` drift unless
/// another candidate gains 0.02 nats per sample.
Bank learn_likeliest_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                              const std::vector<Eigen::Index>& horizons);

}  // namespace modebank
