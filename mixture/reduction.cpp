#include "mixture/reduction.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "ident/base/linalg.hpp"

namespace modebank {

using Eigen::Index;

Component component_of(const GaussianMixture& mixture, Index k) {
  return {mixture.weights(k), mixture.means.col(k), mixture.covariances[static_cast<std::size_t>(k)]};
}

void put(const Component& component, Index k, GaussianMixture& mixture) {
  mixture.weights(k) = component.weight;
  mixture.means.col(k) = component.mean;
  mixture.covariances[static_cast<std::size_t>(k)] = component.covariance;
}

Component merged(const GaussianMixture& mixture, Index i, Index j) {
  const Component a = component_of(mixture, i), b = component_of(mixture, j);
  const double weight = a.weight + b.weight, share = weight > 0.0 ? b.weight / weight : 0.5;
  const Eigen::VectorXd gap = b.mean - a.mean;
  Component result{weight, a.mean + share * gap,
                   (1.0 - share) * a.covariance + share * b.covariance + share * (1.0 - share) * gap * gap.transpose()};
  if (mixture.type == CovarianceType::diagonal) {
    const Eigen::VectorXd variances = result.covariance.diagonal();
    result.covariance = variances.asDiagonal();
  }
  return result;
}

double merge_loss(const GaussianMixture& mixture, Index i, Index j, double log_determinant_i,
                  double log_determinant_j) {
  const Component both = merged(mixture, i, j);
  return 0.5 * (both.weight * log_determinant(both.covariance) - mixture.weights(i) * log_determinant_i -
                mixture.weights(j) * log_determinant_j);
}

std::vector<Merge> merges_by_loss(const GaussianMixture& mixture) {
  std::vector<double> log_determinants;
  for (const Eigen::MatrixXd& covariance : mixture.covariances) log_determinants.push_back(log_determinant(covariance));
  std::vector<Merge> merges;
  for (Index i = 0; i < mixture.components(); ++i)
    for (Index j = i + 1; j < mixture.components(); ++j)
      merges.push_back({i, j,
                        merge_loss(mixture, i, j, log_determinants[static_cast<std::size_t>(i)],
                                   log_determinants[static_cast<std::size_t>(j)])});
  std::stable_sort(merges.begin(), merges.end(), [](const Merge& a, const Merge& b) { return a.loss < b.loss; });
  return merges;
}

Reduction::Reduction(GaussianMixture mixture)
    : mixture_(std::move(mixture)), loss_(mixture_.components(), mixture_.components()) {
  for (Index k = 0; k < mixture_.components(); ++k) {
    alive_.push_back(k);
    log_determinants_.push_back(log_determinant(mixture_.covariances[static_cast<std::size_t>(k)]));
  }
  for (const Index i : alive_)
    for (Index j = 0; j < i; ++j) loss_(j, i) = loss(j, i);
}

double Reduction::loss(Index i, Index j) const {
  return merge_loss(mixture_, i, j, log_determinants_[static_cast<std::size_t>(i)],
                    log_determinants_[static_cast<std::size_t>(j)]);
}

Reduction::Pair Reduction::closest() const {
  const auto loss_of = [&](Index i, Index j) {
    return loss_(alive_[static_cast<std::size_t>(i)], alive_[static_cast<std::size_t>(j)]);
  };
  Pair best{0, 1};
  for (Index i = 0; i < components(); ++i)
    for (Index j = i + 1; j < components(); ++j)
      if (loss_of(i, j) < loss_of(best.into, best.absorbed)) best = {i, j};
  return best;
}

Reduction::Pair Reduction::merge_closest() {
  assert(components() > 1);
  const Pair pair = closest();
  const Index into = alive_[static_cast<std::size_t>(pair.into)];
  put(merged(mixture_, into, alive_[static_cast<std::size_t>(pair.absorbed)]), into, mixture_);
  alive_.erase(alive_.begin() + pair.absorbed);
  log_determinants_[static_cast<std::size_t>(into)] =
      log_determinant(mixture_.covariances[static_cast<std::size_t>(into)]);
  for (const Index k : alive_)
    if (k != into) loss_(std::min(k, into), std::max(k, into)) = loss(std::min(k, into), std::max(k, into));
  return pair;
}

GaussianMixture Reduction::mixture() const {
  GaussianMixture left = mixture_;
  left.weights.resize(components());
  left.means.resize(mixture_.features(), components());
  left.covariances.resize(alive_.size());
  Index place = 0;
  for (const Index k : alive_) put(component_of(mixture_, k), place++, left);
  return left;
}

}  // namespace modebank
