#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/evaluate.hpp"

namespace modebank {

/// One row of /evaluation/summary (method: section 6). Fractions are of the scored samples.
struct SummaryRow {
  std::string filter;  ///< bank, baseline or noise_only
  Role role = Role::train;
  std::string run;           ///< "*": pooled over the samples of all runs of the role
  Eigen::Index samples = 0;  ///< scored samples
  double log_score = 0.0;    ///< mean log predictive density [nats/sample], higher is better
  Eigen::VectorXd rmse;      ///< n_y, of the one-step prediction [state unit]
  double nis_mean = 0.0;
  double nis_above = 0.0;   ///< NIS above the 97.5 % quantile of chi-square(n_y)
  double nis_below = 0.0;   ///< NIS below the 2.5 % quantile
  double tail_above = 0.0;  ///< z^2 above the 97.5 % quantile of chi-square(1), z = Phi^-1(pit)
  double tail_below = 0.0;
  double pit_distance = 0.0;  ///< Kolmogorov distance of pit from uniform
  double whiteness_p = 0.0;   ///< Ljung & Box (1978) p of z, min(20, N/5) lags, pooled over runs by Fisher's method
};

/// Rows of one filter: each run of the role in order, then the pooled "*" row, train first. A role without runs has no
/// rows.
std::vector<SummaryRow> summarize(const std::string& filter, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations);

}  // namespace modebank
