#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mixture/select.hpp"

namespace modebank {

/// Cost in log-likelihood of assigning each point to one component: minus the sum over points of w log max_k r [nats].
/// Zero if every point clearly belongs to one component. A noise component counts as a class.
double classification_cost(const GaussianMixture& mixture, const PointSet& points);

/// Fills the criteria of a row from its log_likelihood, parameters and effective_samples (method: section 3). BIC = -2
/// (N_eff / N) log L + q log N_eff (Schwarz 1978), AIC = -2 (N_eff / N) log L + 2 q (Akaike 1974), ICL = BIC + 2 (N_eff
/// / N) cost (Biernacki, Celeux & Govaert 2000). bic_naive is BIC with N in place of N_eff. N is the points' total
/// weight, `cost` the classification_cost.
void fill_criteria(Candidate& candidate, double total_weight, double cost);

/// Value of a row under the criterion. For every criterion a lower value is better.
double criterion_value(const Candidate& candidate, Criterion criterion);

/// Position of the row with the best criterion. On a tie, the first such row; -1 if no row is finite. Rows whose fit is
/// at the covariance floor rank after all other rows, because the floor determined their likelihood.
Eigen::Index best_candidate(const std::vector<Candidate>& candidates, Criterion criterion);

/// Reasons against trusting the selected row, one sentence for each:
/// - restarts disagree;
/// - the fit is at the covariance floor;
/// - the row is at the edge of the range;
/// - fits did not converge;
/// - another number of components has a better score on left-out runs, by more than two standard errors.
/// Disagreement of criteria does not count, because AIC nearly always chooses more components than BIC.
std::vector<std::string> selection_warnings(const std::vector<Candidate>& candidates);

}  // namespace modebank
