#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "filter/step/bank.hpp"
#include "filter/step/combined_filter.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// Estimates of a filter at every sample of a run, one sample per column; the lagged samples of a bank's state are in
/// earlier columns. The scores of the start are NaN.
struct RunEvaluation {
  Eigen::MatrixXd prediction;             ///< n x N, combined one-step prediction of the state
  Eigen::MatrixXd innovation;             ///< n_y x N, measurement minus combined prediction
  Eigen::MatrixXd innovation_covariance;  ///< n_y*n_y x N, covariance of the combined prediction
  Eigen::MatrixXd state;                  ///< n x N, state after the measurement
  Eigen::MatrixXd covariance;             ///< n*n x N, covariance of the state after the measurement
  Eigen::VectorXd nis;                    ///< N
  Eigen::MatrixXd pit;                    ///< n_y x N, Rosenblatt's transform; drawn by draw_pit for rounded signals
  Eigen::MatrixXd pit_width;              ///< n_y x N, width of the interval of pit; empty if no signal is rounded
  Eigen::VectorXd log_density;            ///< N, nats
  Eigen::MatrixXd mode_probability_predicted;  ///< K x N, mode probabilities before the measurement
  Eigen::MatrixXd mode_probability;            ///< K x N, mode probabilities after the measurement
  Eigen::VectorXi viterbi_mode;                ///< N, result of mode_sequence; empty if nobody asked for it
};

/// Filters one run, whose `state` holds the measurements (n_y x N), from x[0] = y[0], P[0] = R. A signal with a NaN
/// measurement is only predicted; the others update the state and score the sample. The filter starts at the first
/// complete measurement (with lags, the first whose lagged samples are all measured); before, only mode probabilities
/// are not NaN. Throws std::invalid_argument if sizes disagree, and DataError for an input that is not finite.
RunEvaluation evaluate_run(const Bank& bank, const Trajectory& run, const FilterOptions& options);

/// `frame`: a bank with the sizes of the filter's estimates.
RunEvaluation evaluate_run(const Bank& frame, const Trajectory& run, CombinedFilter& filter);

/// Draws the transforms of quantised measurements within their intervals, by seed, run's name and sample number.
void draw_pit(const Trajectory& run, std::uint64_t seed, RunEvaluation& evaluation);

/// Sum of log_densities over the scored samples of a run [nats]: the log-likelihood of theta, Q, R and T.
double log_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options);

/// The most probable sequence of modes of a run (Viterbi), N; -1 before the filter's start. Each mode predicts from the
/// filter's own estimate, in which the sequences up to then are mixed: exact while the state is known (R = 0, no
/// missing samples), else an approximation. A restart of the filter begins a new sequence.
Eigen::VectorXi mode_sequence(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
