#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/local_model.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Number of modes of a smaller start, as a share of the next larger one.
inline constexpr double modes_kept = 0.75;

/// Whether the variance of a sensor's noise is above a tenth of the process noise: then theta of exact states is
/// biased.
inline bool has_noisy_sensor(const Eigen::VectorXd& R, const Eigen::VectorXd& Q) {
  return (R.array() > 0.1 * Q.array()).any();
}

struct Refinement {
  Bank bank;
  Bank start = {};                               ///< the bank of the mixture
  std::vector<RefineCandidate> candidates = {};  ///< best number of iterations for each start
  std::vector<double> objective = {};            ///< penalised log-likelihood before each iteration
  MeasurementStage measurement = {};
  SwitchingStage switching = {};
  std::vector<Bank> of_splits = {};      ///< without the left-out runs of each split (validation_splits); empty if none
  Eigen::Index learned_transitions = 0;  ///< number of transitions learned from (left_out/folds.hpp); 0 means all
};

/// Expectation-maximisation of the switching model (regression.hpp), starting from banks of mixtures and from random
/// stretches, then motions times noise levels (consider_motions), then ties of motions. The score of left-out training
/// runs decides the start and the number of iterations (fewest_motions_as_good). Held-out runs are never used. The last
/// fit uses all training runs. Starved and duplicate modes, and unstable ones that are hardly used, are then removed
/// and listed. Starts whose modes are one motion stay so.
///
/// The prior: theta is normal about the global model, with prior_sd of the windows or else worth one transition (unit
/// information: Kass & Wasserman 1995). Q has four additional transitions of the global residual covariance. Every
/// count of T and of first modes has 0.1 added.
///
/// States first count as measured exactly. If R of one linear motion with measurement noise (ident/lag/armax), or that
/// of rounding, is above a tenth of Q, or R is stated, motions are maximised and scored by the filter with R, which is
/// estimated with them unless it is stated (fit_with_measurement_noise). Throws std::invalid_argument for a motion
/// model.
Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& starts,
                       const RefineOptions& options, const FilterOptions& filter);

/// Fits the theta of `one_motion`, from refine_bank with these runs and options, to its errors up to `horizon` samples
/// ahead (ident/fit/horizon_fit.hpp), and noise and transitions to the likelihood with that theta, without standard
/// errors. Keeps and returns true if the errors of free runs after `measured` samples fall on left-out runs, by the
/// rule.
bool fit_horizon(const Recording& recording, const RefineOptions& options, Eigen::Index horizon, Eigen::Index measured,
                 Refinement& one_motion);

struct StructuresOfModes {
  std::vector<double> scores;  ///< on left-out runs [nats/sample]; minus infinity if the structure cannot be learned
  std::size_t chosen = 0;
};

inline constexpr double least_structure_gain = 0.02;  // [nats/sample]

/// Learns one, two, four and eight modes with each structure from random stretches of the runs. The score is that of
/// the best number of modes. `one_theta`: modes differ only in noise. All structures use the same transitions, at most
/// 10,000, drawn by the seed. The incumbent stays unless another structure gains least_structure_gain, and, if it has
/// at least as many parameters, one standard error. Of those as good as the best, the one with the fewest lags is
/// chosen.
StructuresOfModes compare_structures(const Recording& recording, const std::vector<LinearStructure>& structures,
                                     std::size_t incumbent, bool one_theta, std::uint64_t seed);

}  // namespace modebank
