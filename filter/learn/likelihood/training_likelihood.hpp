#pragma once

#include <Eigen/Core>

#include "filter/step/bank.hpp"
#include "filter/step/likelihood_gradient.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// Horizon and score of look-ahead learning.
struct LookAhead {
  Eigen::Index samples = 1;         ///< h: predictions 1, 2, ... h samples ahead are scored
  Eigen::VectorXd error_unit = {};  ///< n_y, positive units. Scores are minus half the squared errors in these units.
                                    ///< If empty, scores are log densities

  bool counts_errors() const { return error_unit.size() > 0; }
  bool is_likelihood() const { return samples == 1 && !counts_errors(); }
};

/// Scores of look-ahead learning, N; NaN where a filter has no score. Densities: for each sample the mean of its log
/// predictive densities 1, 2, ... h samples ahead [nats]. Their sum is a composite likelihood (Varin, Reid & Firth
/// 2011, Statistica Sinica 21(1)). h = 1 equals log_densities. Errors: minus half the squared errors of the predicted
/// means in given units. This is the objective of simulation error methods (Farina & Piroddi 2010, International
/// Journal of Control 83(7)). The score is 0 if no prediction exists. Near a run's start a sample has fewer
/// predictions; missing predictions count as zero. Predictions from neighbouring origins are nearly the same. So beyond
/// one sample ahead only one origin in h / 4 samples (rounded up) is used, from the filter's start on; for errors this
/// applies to all horizons. Conditions are those of evaluate_run; throws std::invalid_argument for h below 1.
Eigen::VectorXd look_ahead_scores(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                  const LookAhead& look);

/// Sum of look_ahead_scores over a run. For densities one sample ahead it is bit-identical to log_likelihood.
double look_ahead_score(const Bank& bank, const Trajectory& run, const FilterOptions& options, const LookAhead& look);

/// Log-likelihood of all training runs [nats], each from its second sample. Runs in parallel, with a fixed order of
/// summation. `look`: look-ahead score, which then replaces the log-likelihood.
double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options,
                               const LookAhead& look = {});

/// The gradient of training_log_likelihood. Requires has_likelihood_gradient (filter/step).
BankGradient training_gradient(const Bank& bank, const Recording& recording, const FilterOptions& options);

}  // namespace modebank
