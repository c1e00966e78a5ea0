#include "filter/learn/left_out/rule.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

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
  constexpr double proposals = 6.0, taken_by_chance = 0.05;
  return std::max(least_gain, std::log(proposals / taken_by_chance) / samples);
}

bool is_worth_it(const PairedLoss& gain, const Eigen::VectorXd& samples) {
  return std::isfinite(gain.mean) && gain.mean > std::max(gain.standard_error, least_worth(samples.sum()));
}

std::size_t best_candidate(const std::vector<LeftOutScores>& candidates) {
  const auto less = [](const LeftOutScores& a, const LeftOutScores& b) { return total(a) < total(b); };
  return static_cast<std::size_t>(std::ranges::max_element(candidates, less) - candidates.begin());
}

std::size_t fewest_motions_as_good(const std::vector<LeftOutScores>& candidates, double limit) {
  constexpr Eigen::Index fewest_runs = 4;
  constexpr double gain_of_run = 6.0;
  std::map<Eigen::Index, std::size_t> best_of;  // by number of motions
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (const auto [at, first] = best_of.emplace(candidates[i].motions, i);
        !first && total(candidates[i]) > total(candidates[at->second]))
      at->second = i;
  const double highest = total(candidates[best_candidate(candidates)]);
  const auto is_good = [&](const auto& of) { return total(candidates[of.second]) >= highest - limit; };
  auto chosen = std::ranges::find_if(best_of, is_good);
  for (auto more = std::next(chosen); more != best_of.end(); ++more) {
    const Eigen::ArrayXd gain = candidates[more->second].log_likelihood - candidates[chosen->second].log_likelihood;
    if (gain.size() >= fewest_runs && 5 * (gain >= gain_of_run).count() >= 4 * gain.size()) chosen = more;
  }
  std::size_t result = chosen->second;
  const double least = total(candidates[result]) - limit;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].motions != chosen->first || !(total(candidates[i]) >= least)) continue;
    const Eigen::Index fewer = candidates[result].modes - candidates[i].modes;
    if (fewer > 0 || (fewer == 0 && total(candidates[i]) > total(candidates[result]))) result = i;
  }
  return result;
}

}  // namespace modebank
