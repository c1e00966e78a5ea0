#pragma once

#include <cstdint>
#include <vector>

#include "modebank/base/recording.hpp"
#include "modebank/filter/bank.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::judge {

/// Estimates of a filter at every sample of a run, one sample per column; NaN where a value does not exist, as before
/// the start. The n states are those of the sample itself: a bank's lagged samples are in earlier columns.
struct Evaluation {
  Matrix prediction;             ///< n x N, state before the measurement, all modes combined
  Matrix innovation;             ///< n_y x N, measurement minus prediction
  Matrix innovation_covariance;  ///< n_y*n_y x N
  Matrix state;                  ///< n x N, state after the measurement
  Matrix covariance;             ///< n*n x N, covariance of the state after the measurement
  std::vector<double> nis;       ///< N, normalised innovation squared
  Matrix pit;  ///< n_y x N, probability integral transform (Rosenblatt 1952), uniform if the model is correct; drawn
               ///< within its interval for a quantised signal
  std::vector<double> log_density;  ///< N [nats]
  Matrix mode_probability;          ///< K x N, mode probabilities after the measurement
};

/// Filters a run from its first complete measurement. Throws std::invalid_argument if sizes disagree, and DataError for
/// an input that is not finite. `seed` draws the transforms of quantised signals, as job.seed for `modebank run`.
Evaluation evaluate_run(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options = {},
                        std::uint64_t seed = 1);

/// Sum of the log predictive densities over the scored samples of a run [nats]. Stores nothing.
double log_likelihood(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options = {});

}  // namespace modebank::judge
