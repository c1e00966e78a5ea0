#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mixture/select.hpp"

namespace modebank {

/// Fills bic (Schwarz 1978), aic (Akaike 1974) and icl (Biernacki, Celeux & Govaert 2000) of a row from its
/// log_likelihood, parameters and effective_samples (method: section 3):
/// BIC = -2 (N_eff / N) log L + q log N_eff,  AIC = -2 (N_eff / N) log L + 2 q,  ICL = BIC + 2 (N_eff / N) entropy.
/// `entropy` is that of the responsibilities, summed over the `points` = N points.
void fill_criteria(Candidate& candidate, Eigen::Index points, double entropy);

/// - sum r log r over all entries [nats].
double entropy(const Eigen::MatrixXd& responsibilities);

/// What the criterion says of a row, lower is better for every criterion; bic_naive is BIC with N in place of N_eff.
double badness(const Candidate& candidate, Criterion criterion, Eigen::Index points);

/// Position of the best row by the criterion: the first on a tie, rows that are not finite left out; -1 if none is
/// left.
Eigen::Index best_candidate(const std::vector<Candidate>& candidates, Criterion criterion, Eigen::Index points);

}  // namespace modebank
