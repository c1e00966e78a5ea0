#include "mixture/reduction.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace modebank {

using Eigen::Index;

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
