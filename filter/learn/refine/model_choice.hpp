#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "filter/learn/tuning.hpp"

namespace modebank {

/// What a candidate says of the runs left out.
struct LeftOutScores {
  Eigen::Index modes = 0;
  Eigen::VectorXd log_likelihood;  ///< of each run left out [nats]
};

/// What a candidate loses to another one, sample by sample on the same runs.
struct PairedLoss {
  double mean = 0.0;            ///< nats per sample; infinite where the candidate has no score
  double standard_error = 0.0;  ///< of it, clustered by run; 0 for a single run
};

/// With d_r the difference of the log-likelihoods of run r of n_r samples, N their sum and m = sum d_r / N:
/// m and sqrt(R / (R - 1) sum (d_r - m n_r)^2) / N, the ratio estimator over R clusters (Cochran 1977, section 6.4).
PairedLoss paired_loss(const Eigen::VectorXd& better, const Eigen::VectorXd& worse, const Eigen::VectorXd& samples);

/// The candidate with the highest sum of scores; of equal ones the first.
std::size_t best_candidate(const std::vector<LeftOutScores>& candidates);

/// Whether the simpler candidate may stand for the best: its paired loss is within one standard error of that
/// difference (Breiman et al. 1984, section 3.4.3) and at most tuning.most_loss, or too small to matter, at most
/// tuning.least_gain, however well it is known. samples: of each run left out.
bool as_good(const LeftOutScores& candidate, const LeftOutScores& best, const Eigen::VectorXd& samples,
             const RefineTuning& tuning);

/// The candidate that people look at: the fewest modes that are as good as the best candidate; of as many modes the
/// best.
std::size_t fewest_modes_as_good(const std::vector<LeftOutScores>& candidates, const Eigen::VectorXd& samples,
                                 const RefineTuning& tuning);

}  // namespace modebank
