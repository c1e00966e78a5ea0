#include <benchmark/benchmark.h>

#include "ident/base/seed.hpp"
#include "mixture/em.hpp"
#include "tests/bench/bench_data.hpp"

namespace modebank {
namespace {

/// K well separated Gaussians on a line of F features.
GaussianMixture make_mixture(Eigen::Index components, Eigen::Index features, CovarianceType type) {
  GaussianMixture mixture;
  mixture.type = type;
  mixture.weights = Eigen::VectorXd::Constant(components, 1.0 / static_cast<double>(components));
  mixture.means.resize(features, components);
  for (Eigen::Index k = 0; k < components; ++k) mixture.means.col(k).setConstant(3.0 * static_cast<double>(k));
  mixture.covariances.assign(static_cast<std::size_t>(components), Eigen::MatrixXd::Identity(features, features));
  return mixture;
}

/// Twenty EM iterations that start from the true mixture. Arguments: N, F, K, covariance type. Items are points x
/// components x iterations.
void em_iterations(benchmark::State& state) {
  constexpr int iterations = 20;
  const auto type = static_cast<CovarianceType>(state.range(3));
  const GaussianMixture truth = make_mixture(state.range(2), state.range(1), type);
  auto generator = make_generator(1, "bench_em");
  const Eigen::MatrixXd points = sample(truth, state.range(0), generator);
  EmOptions options;
  options.covariance = type;
  options.max_iterations = iterations;
  options.tolerance = 1e-300;
  for (auto _ : state) {
    const EmResult result = fit_em(points, {}, truth, options);
    bench::check((result.mixture.means - truth.means).cwiseAbs().maxCoeff() < 0.5, "EM left the truth");
    benchmark::DoNotOptimize(result.log_likelihood);
  }
  state.SetItemsProcessed(state.iterations() * iterations * state.range(0) * state.range(2));
  state.SetLabel(std::string(name_of(type)));
}
BENCHMARK(em_iterations)
    ->ArgNames({"N", "F", "K", "shape"})
    ->Args({3000, 3, 8, 0})
    ->Args({3000, 3, 8, 1})
    ->Args({100000, 3, 16, 0})
    ->Args({100000, 12, 16, 0})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace modebank
