#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "filter/learn/tuning.hpp"

namespace modebank {

/// Scores of a candidate on the left-out runs.
struct LeftOutScores {
  Eigen::Index modes = 0;
  Eigen::VectorXd log_likelihood;  ///< log-likelihood of each left-out run [nats]
};

/// Difference of two candidates' scores, sample by sample on the same runs.
struct PairedLoss {
  double mean = 0.0;            ///< nats per sample; infinite if a score is not finite
  double standard_error = 0.0;  ///< standard error of the mean, clustered by run; 0 if there is a single run
};

/// Computes m = sum d_r / N and its standard error sqrt(R / (R - 1) sum (d_r - m n_r)^2) / N. d_r is the difference of
/// the log-likelihoods of run r with n_r samples, N their sum. It is the ratio estimator over R clusters (Cochran 1977,
/// section 6.4).
PairedLoss paired_loss(const Eigen::VectorXd& better, const Eigen::VectorXd& worse, const Eigen::VectorXd& samples);

/// Smallest gain per sample for accepting an addition to a model. It is at least refine_tuning.least_gain. Over all
/// samples together it is at least log(refine_tuning.proposals / taken_by_chance). By chance, the log-likelihood of
/// left-out runs gains this much with probability at most taken_by_chance / proposals. The reason: a likelihood ratio
/// has expectation one, and Markov's inequality bounds its tail.
double least_worth(double samples);

/// The rule for accepting every addition to a model: more modes, noise by input, transitions by state. The `gain` on
/// left-out runs must exceed least_worth. It must also exceed its standard error by run, which is capped at
/// `most_error`. `samples`: number of samples of each left-out run. Other rules are worse. The standard error alone
/// accepts additions to three of ten systems that have none. A t-test over six runs rejects drift worth 0.06 nats in
/// four of five systems.
bool is_worth_it(const PairedLoss& gain, const Eigen::VectorXd& samples,
                 double most_error = std::numeric_limits<double>::infinity());

/// The candidate with the highest sum of scores; the first one if several are equal.
std::size_t best_candidate(const std::vector<LeftOutScores>& candidates);

/// The candidate with the fewest modes whose loss against the best one is within one standard error (Breiman et al.
/// 1984, section 3.4.3), which is capped at tuning.most_loss. If several have this number of modes, takes the one with
/// the highest score. `samples`: number of samples of each left-out run.
std::size_t fewest_modes_as_good(const std::vector<LeftOutScores>& candidates, const Eigen::VectorXd& samples,
                                 const RefineTuning& tuning);

}  // namespace modebank
