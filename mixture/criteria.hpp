#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mixture/select.hpp"

namespace modebank {

/// Fills the criteria of a row from its log_likelihood, parameters and effective_samples (method: section 3). BIC = -2
/// (N_eff / N) log L + q log N_eff (Schwarz 1978), AIC = -2 (N_eff / N) log L + 2 q (Akaike 1974). bic_naive is BIC
/// with N in place of N_eff. N is the points' total weight.
void fill_criteria(Candidate& candidate, double total_weight);

/// Position of the row with the lowest BIC. On a tie, the first such row; -1 if no row is finite. Rows whose fit is
/// at the covariance floor rank after all other rows, because the floor determined their likelihood.
Eigen::Index best_candidate(const std::vector<Candidate>& candidates);

/// Reasons against trusting the selected row, one sentence for each:
/// - restarts disagree;
/// - the fit is at the covariance floor;
/// - the row is at the edge of the range;
/// - fits did not converge.
/// A better AIC does not count, because AIC nearly always chooses more components than BIC.
std::vector<std::string> selection_warnings(const std::vector<Candidate>& candidates);

}  // namespace modebank
