#pragma once

#include <cstdint>
#include <vector>

#include "modebank/base/recording.hpp"
#include "modebank/filter/bank.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::judge {

/// Estimates of a filter at every sample of a run, one sample per column; a value that does not exist is NaN, as before
/// the start. The n states are those of the sample itself: lagged samples of a bank with lags are in earlier columns.
struct Evaluation {
  Matrix prediction;                ///< n x N, of the state before the measurement, all modes combined
  Matrix innovation;                ///< n_y x N, measurement minus prediction
  Matrix innovation_covariance;     ///< n_y*n_y x N
  Matrix state;                     ///< n x N, after the measurement
  Matrix covariance;                ///< n*n x N, after the measurement
  std::vector<double> nis;          ///< N, normalised innovation squared
  Matrix pit;                       ///< n_y x N, probability integral transform (Rosenblatt 1952), uniform in a true
                                    ///< filter: of a quantised signal drawn uniformly within its interval
  std::vector<double> log_density;  ///< N [nats]
  Matrix mode_probability;          ///< K x N, after the measurement
};

/// Runs the filter over a run from its first whole measurement. Throws std::invalid_argument when sizes disagree and
/// DataError for an input that is not finite. `seed`: of the transforms of quantised signals, which are those of
/// `modebank run` with the same job.seed and run name.
Evaluation evaluate_run(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options = {},
                        std::uint64_t seed = 1);

/// Sum of the log predictive densities over the scored samples of a run [nats]. Nothing is stored.
double log_likelihood(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options = {});

/// Smoothed states of a run, given all of it; n as in Evaluation.
struct Smoothed {
  Matrix state;                          ///< n x N
  Matrix covariance;                     ///< n*n x N
  std::vector<int> most_probable_modes;  ///< N, the most probable sequence (Viterbi); -1 before the start
};

/// evaluate_run's filter, then backwards (Kim 1994), and the most probable sequence of modes.
Smoothed smooth_run(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options = {});

}  // namespace modebank::judge
