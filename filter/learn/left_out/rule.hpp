#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "filter/learn/tuning.hpp"

namespace modebank {

/// Scores of a candidate on the runs left out.
struct LeftOutScores {
  Eigen::Index modes = 0;
  Eigen::VectorXd log_likelihood;  ///< of each run left out [nats]
};

/// The difference between the scores of two candidates, sample by sample on the same runs.
struct PairedLoss {
  double mean = 0.0;            ///< nats per sample; infinite where a score is not finite
  double standard_error = 0.0;  ///< of it, clustered by run; 0 for a single run
};

/// With d_r the difference of the log-likelihoods of run r of n_r samples, N their sum and m = sum d_r / N:
/// m and sqrt(R / (R - 1) sum (d_r - m n_r)^2) / N, the ratio estimator over R clusters (Cochran 1977, section 6.4).
PairedLoss paired_loss(const Eigen::VectorXd& better, const Eigen::VectorXd& worse, const Eigen::VectorXd& samples);

/// The least that anything a model may add has to gain, nats per sample: refine_tuning.least_gain, and all samples
/// together the logarithm of refine_tuning.proposals / taken_by_chance. Left-out log-likelihoods differ by that much in
/// favour of what is not there with at most probability taken_by_chance / proposals: the expectation of a likelihood
/// ratio is one, and Markov's inequality does the rest.
double least_worth(double samples);

/// The rule by which whatever a model may add is taken (more modes, noise by input, transitions by state, drift, a fit
/// that looks ahead): `gain` on runs left out is above least_worth and above its standard error by run, of which
/// `most_error` counts at most. That error alone takes what is not there in three systems of ten, and a t-test over six
/// runs passes over drift that is worth 0.06 nats in four of five (docs/results/rule.md). `samples`: of each run left
/// out.
bool is_worth_it(const PairedLoss& gain, const Eigen::VectorXd& samples,
                 double most_error = std::numeric_limits<double>::infinity());

/// The candidate with the highest sum of scores; of equal ones the first.
std::size_t best_candidate(const std::vector<LeftOutScores>& candidates);

/// Whether the simpler candidate may stand for the best, which is not worth it (Breiman et al. 1984, section 3.4.3: one
/// standard error); tuning.most_loss of that error counts at most. samples: of each run left out.
bool as_good(const LeftOutScores& candidate, const LeftOutScores& best, const Eigen::VectorXd& samples,
             const RefineTuning& tuning);

/// The candidate that people look at: the fewest modes that are as good as the best candidate; of as many modes the
/// best.
std::size_t fewest_modes_as_good(const std::vector<LeftOutScores>& candidates, const Eigen::VectorXd& samples,
                                 const RefineTuning& tuning);

}  // namespace modebank
