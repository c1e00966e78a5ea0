#include "filter/learn/left_out/rule.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/clustered_error.hpp"

namespace modebank {
namespace {

double total(const LeftOutScores& candidate) {
  const double sum = candidate.log_likelihood.sum();
  return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum;
}

}  // namespace

PairedLoss paired_loss(const Eigen::VectorXd& better, const Eigen::VectorXd& worse, const Eigen::VectorXd& samples) {
  const Eigen::VectorXd difference = better - worse;
  if (!difference.allFinite()) return {std::numeric_limits<double>::infinity(), 0.0};
  return {difference.sum() / samples.sum(), clustered_error(difference, samples)};
}

double least_worth(double samples) {
  constexpr double proposals = 7.0, taken_by_chance = 0.05;
  return std::max(least_gain, std::log(proposals / taken_by_chance) / samples);
}

bool is_worth_it(const PairedLoss& gain, const Eigen::VectorXd& samples, double most_error) {
  return std::isfinite(gain.mean) &&
         gain.mean > std::max(std::min(gain.standard_error, most_error), least_worth(samples.sum()));
}

std::size_t best_candidate(const std::vector<LeftOutScores>& candidates) {
  const auto less = [](const LeftOutScores& a, const LeftOutScores& b) { return total(a) < total(b); };
  return static_cast<std::size_t>(std::ranges::max_element(candidates, less) - candidates.begin());
}

std::size_t fewest_modes_as_good(const std::vector<LeftOutScores>& candidates, const Eigen::VectorXd& samples) {
  constexpr double most_loss = 0.02;
  const std::size_t best = best_candidate(candidates);
  std::size_t chosen = best;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const PairedLoss loss = paired_loss(candidates[best].log_likelihood, candidates[i].log_likelihood, samples);
    if (!std::isfinite(loss.mean) || is_worth_it(loss, samples, most_loss)) continue;
    const Eigen::Index fewer = candidates[chosen].modes - candidates[i].modes;
    if (fewer > 0 || (fewer == 0 && total(candidates[i]) > total(candidates[chosen]))) chosen = i;
  }
  return chosen;
}

}  // namespace modebank
