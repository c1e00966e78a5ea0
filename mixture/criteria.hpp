#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mixture/select.hpp"

namespace modebank {

/// Fills bic (Schwarz 1978), aic (Akaike 1974), icl (Biernacki, Celeux & Govaert 2000) and bic_naive of a row from its
/// log_likelihood, parameters and effective_samples (method: section 3):
/// BIC = -2 (N_eff / N) log L + q log N_eff,  AIC = -2 (N_eff / N) log L + 2 q,  ICL = BIC + 2 (N_eff / N) entropy;
/// bic_naive is BIC with N in place of N_eff. N is the points' total weight, `entropy` that of the responsibilities
/// (classification_entropy), summed over the points.
void fill_criteria(Candidate& candidate, double total_weight, double entropy);

/// What the criterion says of a row, lower is better for every criterion.
double badness(const Candidate& candidate, Criterion criterion);

/// Position of the best row by the criterion: the first on a tie, rows that are not finite left out; -1 if none is
/// left.
Eigen::Index best_candidate(const std::vector<Candidate>& candidates, Criterion criterion);

/// What the table says against trusting the selected row: restarts that disagree, the range's edge, other criteria that
/// would choose otherwise, fits that did not converge. One sentence each.
std::vector<std::string> selection_warnings(const std::vector<Candidate>& candidates);

}  // namespace modebank
