#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mixture/select.hpp"

namespace modebank {

/// - sum over the points of w log max_k r: what it costs the likelihood that points are assigned outright [nats]. Zero
/// where no point is doubtful. With a noise component that counts as a class.
double classification_cost(const GaussianMixture& mixture, const PointSet& points);

/// Fills bic (Schwarz 1978), aic (Akaike 1974), icl (Biernacki, Celeux & Govaert 2000) and bic_naive of a row from its
/// log_likelihood, parameters and effective_samples (method: section 3):
/// BIC = -2 (N_eff / N) log L + q log N_eff,  AIC = -2 (N_eff / N) log L + 2 q,  ICL = BIC + 2 (N_eff / N) cost;
/// bic_naive is BIC with N in place of N_eff. N is the points' total weight, `cost` the classification_cost.
void fill_criteria(Candidate& candidate, double total_weight, double cost);

/// What the criterion says of a row, lower is better for every criterion.
double badness(const Candidate& candidate, Criterion criterion);

/// Position of the best row by the criterion: the first on a tie, rows that are not finite left out; -1 if none is
/// left. A row that rests on the covariance floor has a likelihood that the floor chose: it comes after all that do
/// not.
Eigen::Index best_candidate(const std::vector<Candidate>& candidates, Criterion criterion);

/// What the table says against trusting the selected row: restarts that disagree, the covariance floor, the range's
/// edge, runs left out that are described better by another number by more than two standard errors, fits that did not
/// converge. One sentence each. (That criteria differ says nothing: AIC asks for more components than BIC nearly
/// always.)
std::vector<std::string> selection_warnings(const std::vector<Candidate>& candidates);

}  // namespace modebank
