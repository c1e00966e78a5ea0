#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// What the settings of a drifting model are chosen from (method: section 6). Values in the order of preference among
/// equals; q, p0 and floor ascend, leak descends.
struct DriftingGrid {
  std::vector<double> q{0.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
  std::vector<double> p0{0.0, 1e-2, 1e-1, 1.0, 10.0};
  std::vector<double> leak{1.0, 0.97, 0.9};
  std::vector<double> lam{0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.92, 0.96};
  std::vector<double> nu{0.0, 3.0, 5.0, 8.0, 15.0};
  std::vector<double> floor{1e-6, 1e-5, 1e-4, 1e-3};  ///< of the training residuals' variance

  /// q, p0, leak, lam, nu, floor: the last runs fastest.
  std::array<Eigen::Index, 6> sizes() const {
    return {std::ssize(q), std::ssize(p0), std::ssize(leak), std::ssize(lam), std::ssize(nu), std::ssize(floor)};
  }
  /// The positions of a point of the grid.
  std::array<Eigen::Index, 6> point(Eigen::Index index) const;
};

/// The log score of the training runs at every point of the grid [nats/sample].
struct DriftingScores {
  Eigen::VectorXd log_score;
  Eigen::Index samples = 0;  ///< scored, each counting the same whatever its weight
  /// n x (q, p0, leak): the mean of e^2 / (1 + h'Ph), over v0.
  Eigen::MatrixXd error_ratio = {};
  /// The point of the highest score, the first of equals.
  Eigen::Index best() const;
};

/// The competitor `drifting` is a bank of one mode that drifts, with running noise. `start`: one whose theta, scale, Q
/// and what wanders are those of the training runs; its other settings do not matter. One recursion of the coefficients
/// per (q, p0, leak), from which all running variances follow, from which all densities follow. Throws
/// std::invalid_argument for an empty grid, and DataError when nothing can be scored.
DriftingScores score_drifting_grid(const Bank& start, const Recording& recording, const DriftingGrid& grid);

/// Root mean square of every regressor over the training transitions, each counting the same; 1 for what is always
/// zero. Throws DataError where there is none.
Eigen::VectorXd regressor_scale(const Recording& recording, const LinearStructure& structure);

/// The competitor `drifting`. `global`: least squares of this structure on the training runs. Its settings are the best
/// of the grid by the training runs' log score, one sample ahead; then for each of `horizons` from 2 on the factor of
/// its variance is the one of 2^(-4), 2^(-3.75), ..., 2^8 that makes the training runs' errors most likely. Samples
/// count the same whatever their weights. Where one factor wanders v0 is the variance of the model's own errors: those
/// of constant coefficients hold what wanders.
Bank learn_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                    const std::vector<Eigen::Index>& horizons, const DriftingGrid& grid = {},
                    Wandering wandering = Wandering::all);

/// A model with the settings of `like`, its theta0 and variances of these training runs.
Bank relearn_drifting(const Bank& like, const Recording& recording, const GlobalModel& global);

/// Fewer settings, to compare models rather than to forecast with one.
DriftingGrid coarse_drifting_grid();
/// Causal log score of the training runs' transitions from `latest` on, the first that the model with the longest
/// memory predicts, by the model of this structure that they teach; minus infinity where it cannot be learned.
double drifting_training_score(const Recording& recording, Eigen::Index latest, const LinearStructure& structure,
                               const DriftingGrid& grid, Wandering wandering = Wandering::all);

/// learn_drifting of whatever wanders most likely in the training runs: all coefficients of `structure`, its constant
/// (which it has then), one factor on the coefficients of its inputs, or the same with one lag. The causal score of at
/// most 20,000 transitions and settings of the coarse grid choose; all coefficients of `structure` stay where nothing
/// gains 0.02 nats per sample.
Bank learn_likeliest_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                              const std::vector<Eigen::Index>& horizons);

}  // namespace modebank
