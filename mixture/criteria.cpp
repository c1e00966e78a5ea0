#include "mixture/criteria.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ident/base/not_a_number.hpp"

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

double classification_cost(const GaussianMixture& mixture, const PointSet& points) {
  double cost = 0.0;
  visit_responsibilities(mixture, points, [&](Index first, const Eigen::Ref<const Eigen::MatrixXd>& columns) {
    for (Index i = 0; i < columns.cols(); ++i) {
      const double noise = mixture.noise.present() ? 1.0 - columns.col(i).sum() : 0.0;
      const double weight = points.weights.size() > 0 ? points.weights(first + i) : 1.0;
      cost -= weight * std::log(std::max(noise, columns.col(i).maxCoeff()));
    }
  });
  return std::max(0.0, cost);
}

void fill_criteria(Candidate& candidate, double total_weight, double cost) {
  const double share = candidate.effective_samples / total_weight;
  const double q = static_cast<double>(candidate.parameters);
  const double deviance = -2.0 * share * candidate.log_likelihood;
  candidate.bic = deviance + q * std::log(candidate.effective_samples);
  candidate.aic = deviance + 2.0 * q;
  candidate.icl = candidate.bic + 2.0 * share * cost;
  candidate.bic_naive = -2.0 * candidate.log_likelihood + q * std::log(total_weight);
}

double criterion_value(const Candidate& candidate, Criterion criterion) {
  switch (criterion) {
    case Criterion::bic:
      return candidate.bic;
    case Criterion::icl:
      return candidate.icl;
    case Criterion::heldout:
      return -candidate.heldout;
    case Criterion::bic_naive:
      return candidate.bic_naive;
  }
  return not_a_number;
}

Index best_candidate(const std::vector<Candidate>& candidates, Criterion criterion) {
  Index best = -1;
  const auto better = [&](const Candidate& a, const Candidate& b) {
    if (a.floor_active != b.floor_active) return b.floor_active;
    return criterion_value(a, criterion) < criterion_value(b, criterion);
  };
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (std::isfinite(criterion_value(candidates[i], criterion)) &&
        (best < 0 || better(candidates[i], candidates[static_cast<std::size_t>(best)])))
      best = static_cast<Index>(i);
  return best;
}

namespace {

/// A difference of held-out scores counts as chance if it is below this number of standard errors. The reason: the
/// score is the best of up to twelve.
constexpr double standard_errors = 2.0;

std::string disagreement(const std::vector<Candidate>& candidates, const Candidate& selected) {
  const Index best = best_candidate(candidates, Criterion::heldout);
  if (best < 0) return "";
  const Candidate& other = candidates[static_cast<std::size_t>(best)];
  const double gain = other.heldout - selected.heldout;
  if (!(gain > standard_errors * other.heldout_error)) return "";
  return fmt::format(
      "windows of left-out runs are more likely with {} components than with {}: by {:.3g} +- {:.2g} nats "
      "per window",
      other.components, selected.components, gain, other.heldout_error);
}

}  // namespace

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
  if (std::string text = disagreement(candidates, *selected); !text.empty()) warnings.push_back(std::move(text));
  return warnings;
}

}  // namespace modebank
