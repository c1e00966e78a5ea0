#include "mixture/criteria.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "ident/not_a_number.hpp"

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

void fill_criteria(Candidate& candidate, Index points, double entropy) {
  const double share = candidate.effective_samples / static_cast<double>(points);
  const double q = static_cast<double>(candidate.parameters);
  const double deviance = -2.0 * share * candidate.log_likelihood;
  candidate.bic = deviance + q * std::log(candidate.effective_samples);
  candidate.aic = deviance + 2.0 * q;
  candidate.icl = candidate.bic + 2.0 * share * entropy;
}

double entropy(const Eigen::MatrixXd& responsibilities) {
  return -responsibilities.unaryExpr([](double r) { return r > 0.0 ? r * std::log(r) : 0.0; }).sum();
}

double badness(const Candidate& candidate, Criterion criterion, Index points) {
  switch (criterion) {
    case Criterion::bic:
      return candidate.bic;
    case Criterion::icl:
      return candidate.icl;
    case Criterion::aic:
      return candidate.aic;
    case Criterion::heldout:
      return -candidate.heldout;
    case Criterion::bic_naive:
      return -2.0 * candidate.log_likelihood +
             static_cast<double>(candidate.parameters) * std::log(static_cast<double>(points));
  }
  return not_a_number;
}

Index best_candidate(const std::vector<Candidate>& candidates, Criterion criterion, Index points) {
  Index best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const double value = badness(candidates[i], criterion, points);
    if (!std::isfinite(value) || value >= least) continue;
    least = value;
    best = static_cast<Index>(i);
  }
  return best;
}

}  // namespace modebank
