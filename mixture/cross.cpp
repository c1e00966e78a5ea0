#include "mixture/cross.hpp"

#include "mixture/reduction.hpp"

namespace modebank {

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

}  // namespace

GaussianMixture cross(const GaussianMixture& a, const GaussianMixture& b) {
  Reduction reduction(union_of(a, b));
  while (reduction.components() > a.components()) reduction.merge_closest();
  return reduction.mixture();
}

}  // namespace modebank
