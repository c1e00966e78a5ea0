#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"
#include "filter/sample_feed.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// imm: Blom & Bar-Shalom (1988). mmae: no mixing. gpb1, gpb2: generalised pseudo-Bayesian of first and second order
/// (Ackerson & Fu 1970; Chang & Athans 1978; Bar-Shalom, Li & Kirubarajan 2001, sections 11.6.4 and 11.6.5): all modes
/// start from one common estimate, or each mode from each mode's own (K^2 Kalman steps, then merged). salvi2025: the
/// printed equations 12-18. kf: the bank's first mode alone.
enum class FilterVariant { imm, mmae, gpb1, gpb2, salvi2025, kf };

template <>
struct EnumNames<FilterVariant> {
  static constexpr Names<6> values{"imm", "mmae", "gpb1", "gpb2", "salvi2025", "kf"};
};

/// gaussian: Q as learned. adaptive: Q times a scale that follows the run (noise_scale.hpp).
enum class FilterNoise { gaussian, adaptive };

template <>
struct EnumNames<FilterNoise> {
  static constexpr Names<2> values{"gaussian", "adaptive"};
};

struct FilterOptions {
  FilterVariant variant = FilterVariant::imm;
  bool parameter_noise = false;  ///< Q_k = Q + (I (x) phi') Sigma_theta (I (x) phi')' with the mode's spread
  TimeSteps time_steps = TimeSteps::repeat;
  FilterNoise noise = FilterNoise::gaussian;

  bool operator==(const FilterOptions&) const = default;
};

/// What a filter said about every sample of a run, one sample per column. Column 0 is the start: its scores are NaN.
struct RunEvaluation {
  Eigen::MatrixXd prediction;                  ///< n x N, combined one-step prediction of the state
  Eigen::MatrixXd innovation;                  ///< n_y x N, measurement minus combined prediction
  Eigen::MatrixXd innovation_covariance;       ///< n_y*n_y x N, of the combined prediction
  Eigen::MatrixXd state;                       ///< n x N, after the measurement
  Eigen::MatrixXd covariance;                  ///< n*n x N, after the measurement
  Eigen::VectorXd nis;                         ///< N
  Eigen::MatrixXd pit;                         ///< n_y x N, Rosenblatt's transform
  Eigen::VectorXd log_density;                 ///< N, nats
  Eigen::MatrixXd mode_probability_predicted;  ///< K x N, before the measurement
  Eigen::MatrixXd mode_probability;            ///< K x N, after the measurement
  Eigen::VectorXd spread_share;                ///< N, of the modes' differences in the trace of innovation_covariance
  // By smooth_run; empty without.
  Eigen::MatrixXd smoothed_state;       ///< n x N, given the whole run
  Eigen::MatrixXd smoothed_covariance;  ///< n*n x N
  Eigen::VectorXi viterbi_mode;         ///< N, the most probable sequence of modes; -1 before the start
};

/// Runs the filter over one run, whose `state` holds the measurements (n_y x N), starting at x[0] = y[0], P[0] = R. A
/// signal whose measurement is NaN is predicted only: the others are taken in, and the sample is scored by them;
/// without any its innovation and scores are NaN. When the first measurements are NaN the first whole one is the start,
/// and everything before it is NaN but the mode probabilities; a bank with lags starts at the first sample whose lagged
/// samples are all measured. Longer times between samples: see TimeSteps. Throws std::invalid_argument when sizes
/// disagree and DataError for an input that is not finite.
RunEvaluation evaluate_run(const Bank& bank, const Trajectory& run, const FilterOptions& options);

/// Sum of log predictive densities over the scored samples of a run [nats]: the log-likelihood of theta, Q, R and T.
/// Nothing is stored, so maximum likelihood may call it thousands of times. Same conditions as evaluate_run.
double log_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options);

/// The log likelihoods of many runs at once, run i with bank i: scalar banks go through the processor's vector
/// registers together, a run per lane, as learning and cross-validation score them. To rounding the same numbers.
std::vector<double> log_likelihoods(const std::vector<const Bank*>& banks, const std::vector<const Trajectory*>& runs,
                                    const FilterOptions& options);

/// The log predictive density of every sample of a run [nats], N; NaN where there is none.
Eigen::VectorXd log_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
