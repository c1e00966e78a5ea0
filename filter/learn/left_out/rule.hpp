#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

/// The rule by which left-out runs decide.
namespace modebank {

struct LeftOutScores {
  Eigen::Index modes = 0;
  Eigen::VectorXd log_likelihood;  ///< of each left-out run [nats]
  Eigen::Index motions = 0;
};

/// Difference of two candidates' scores, sample by sample on the same runs.
struct PairedLoss {
  double mean = 0.0;            ///< nats per sample; infinite if a score is not finite
  double standard_error = 0.0;  ///< clustered by run; 0 if there is a single run
};

/// m = sum d_r / N with its standard error sqrt(R / (R - 1) sum (d_r - m n_r)^2) / N, the ratio estimator over R
/// clusters (Cochran 1977, section 6.4). d_r: difference of the log-likelihoods of run r with n_r samples, N their sum.
PairedLoss paired_loss(const Eigen::VectorXd& better, const Eigen::VectorXd& worse, const Eigen::VectorXd& samples);

/// Nats per sample. Smaller gains do not hold on other runs: other seeds change held-out scores by 0.03 to 0.07.
inline constexpr double least_gain = 1e-3;

/// Smallest gain per sample for an addition to a model: at least least_gain, and log(6 / 0.05) nats over all samples.
/// By chance left-out runs gain that much with probability 0.05 / 6 at most, because a likelihood ratio has expectation
/// one (Markov's inequality). One configuration has at most six proposals: number of modes, two priors, measurement
/// noise, transitions by state, a fit over a horizon.
double least_worth(double samples);

/// The rule for accepting every other addition to a model. The `gain` on left-out runs must exceed least_worth and its
/// standard error by run. `samples`: of each left-out run. Other rules are worse: the
/// standard error alone accepts additions to three of ten systems that have none; a t-test over six runs rejects drift
/// worth 0.06 nats in four of five systems.
bool is_worth_it(const PairedLoss& gain, const Eigen::VectorXd& samples);

/// The candidate with the highest sum of scores; the first one if several are equal.
std::size_t best_candidate(const std::vector<LeftOutScores>& candidates);

/// The candidate with the fewest motions whose sum of scores is within `limit` nats of the best one; of these with the
/// fewest modes within the limit of the best of them; of these with the highest score. A rare motion counts, too, if at
/// least four runs, and four fifths of them, each gain six nats by it.
std::size_t fewest_motions_as_good(const std::vector<LeftOutScores>& candidates, double limit);

}  // namespace modebank
