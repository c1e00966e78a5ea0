#include "mixture/cross.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "mixture/component_merge.hpp"

namespace modebank {

using Eigen::Index;

namespace {

GaussianMixture union_of(const GaussianMixture& a, const GaussianMixture& b) {
  GaussianMixture both = a;
  both.weights.resize(a.components() + b.components());
  both.weights << 0.5 * a.weights, 0.5 * b.weights;
  both.means.resize(a.features(), both.weights.size());
  both.means << a.means, b.means;
  both.covariances.insert(both.covariances.end(), b.covariances.begin(), b.covariances.end());
  both.noise.weight = 0.5 * (a.noise.weight + b.noise.weight);
  return both;
}

/// Merges pairs in place, each kept in the earlier one's place; what merging any pair would cost is kept up to date.
class Reduction {
 public:
  explicit Reduction(GaussianMixture& mixture) : mixture_(mixture), loss_(mixture.components(), mixture.components()) {
    for (Index k = 0; k < mixture.components(); ++k) {
      alive_.push_back(k);
      log_determinants_.push_back(log_determinant(mixture.covariances[static_cast<std::size_t>(k)]));
    }
    for (const Index i : alive_)
      for (Index j = 0; j < i; ++j) loss_(j, i) = loss(j, i);
  }

  void merge_closest() {
    Index first = 0, second = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 1; j < alive_.size(); ++j)
      for (std::size_t i = 0; i < j; ++i)
        if (const double candidate = loss_(alive_[i], alive_[j]); second == 0 || candidate < least) {
          least = candidate;
          first = alive_[i];
          second = alive_[j];
        }
    put(merged(mixture_, first, second), first, mixture_);
    log_determinants_[static_cast<std::size_t>(first)] =
        log_determinant(mixture_.covariances[static_cast<std::size_t>(first)]);
    std::erase(alive_, second);
    for (const Index k : alive_)
      if (k != first) loss_(std::min(k, first), std::max(k, first)) = loss(std::min(k, first), std::max(k, first));
  }

  const std::vector<Index>& alive() const { return alive_; }

 private:
  double loss(Index i, Index j) const {
    return merge_loss(mixture_, i, j, log_determinants_[static_cast<std::size_t>(i)],
                      log_determinants_[static_cast<std::size_t>(j)]);
  }

  GaussianMixture& mixture_;
  Eigen::MatrixXd loss_;  // of i < j
  std::vector<double> log_determinants_;
  std::vector<Index> alive_;  // in order
};

}  // namespace

GaussianMixture cross(const GaussianMixture& a, const GaussianMixture& b) {
  GaussianMixture both = union_of(a, b);
  Reduction reduction(both);
  while (std::ssize(reduction.alive()) > a.components()) reduction.merge_closest();
  GaussianMixture result = a;
  result.noise = both.noise;
  Index place = 0;
  for (const Index k : reduction.alive()) put(component_of(both, k), place++, result);
  return result;
}

}  // namespace modebank
