#include "mixture/criteria.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace modebank {

using Eigen::Index;

double effective_samples(const FeatureCloud& cloud, Index length, Index step) {
  std::map<Index, Index> windows_of_run;
  for (const Index run : cloud.runs) ++windows_of_run[run];
  double sum = 0.0;
  for (const auto& [run, windows] : windows_of_run)
    sum += std::max(1.0, static_cast<double>(windows * step) / static_cast<double>(length));
  return std::min(static_cast<double>(cloud.runs.size()), sum);
}

void fill_criteria(Candidate& candidate, double total_weight) {
  const double share = candidate.effective_samples / total_weight;
  const double q = static_cast<double>(candidate.parameters);
  const double deviance = -2.0 * share * candidate.log_likelihood;
  candidate.bic = deviance + q * std::log(candidate.effective_samples);
  candidate.aic = deviance + 2.0 * q;
  candidate.bic_naive = -2.0 * candidate.log_likelihood + q * std::log(total_weight);
}

Index best_candidate(const std::vector<Candidate>& candidates) {
  Index best = -1;
  const auto better = [&](const Candidate& a, const Candidate& b) {
    if (a.floor_active != b.floor_active) return b.floor_active;
    return a.bic < b.bic;
  };
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (std::isfinite(candidates[i].bic) &&
        (best < 0 || better(candidates[i], candidates[static_cast<std::size_t>(best)])))
      best = static_cast<Index>(i);
  return best;
}

std::vector<std::string> selection_warnings(const std::vector<Candidate>& candidates) {
  std::vector<std::string> warnings;
  const auto selected =
      std::find_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.selected; });
  if (selected == candidates.end()) return warnings;
  const Index components = selected->components;
  if (2 * selected->agreeing_restarts < selected->restarts)
    warnings.push_back(fmt::format(
        "{} of {} restarts reached the best optimum of {} components; more restarts may find a better optimum",
        selected->agreeing_restarts, selected->restarts, components));
  if (selected->floor_active)
    warnings.push_back(fmt::format(
        "every candidate has a component at the lower limit covariance_floor: the choice of {} components depends on "
        "this limit",
        components));
  if (!selected->converged)
    warnings.push_back(fmt::format("EM of {} components did not converge within max_iterations", components));
  if (candidates.size() < 2) return warnings;
  const bool least = selected == candidates.begin() && components > 1;
  if (least || selected + 1 == candidates.end())
    warnings.push_back(fmt::format("{} components are the {} of all candidates: widen the range of candidates",
                                   components, least ? "fewest" : "most"));
  return warnings;
}

}  // namespace modebank
