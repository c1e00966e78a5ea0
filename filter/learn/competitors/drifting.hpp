#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

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

/// Root mean square of every regressor over the training transitions, with equal weights; 1 if a regressor is always
/// zero. Throws DataError without transitions.
Eigen::VectorXd regressor_scale(const Recording& recording, const LinearStructure& structure);

/// Learns the competitor `drifting`. `global`: least squares of this structure on the training runs. The settings are
/// those of the grid with the best log score of the training runs one sample ahead. Each of `horizons` from 2 on has a
/// factor on the variance. Of 2^(-4), 2^(-3.75), ..., 2^8, it is the factor that makes the training errors most likely.
/// All samples have equal weight. If one common factor drifts, v0 is the variance of the drifting model's own errors.
/// Errors of a model with constant coefficients would include the drift.
Bank learn_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                    const std::vector<Eigen::Index>& horizons, const DriftingGrid& grid = {},
                    Wandering wandering = Wandering::all);

/// Chooses the variance's factor of each horizon from 2 on, as learn_drifting.
void choose_horizon_factors(Bank& bank, const Recording& recording, std::vector<Eigen::Index> horizons);

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
