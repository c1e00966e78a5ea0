// Armadillo's mixtures from the given start. This file may use all instruction sets of this machine: CMake compiles it
// with -O3 -march=native.
#include "tests/bench/em_cases.hpp"

#ifdef MODEBANK_HAS_ARMADILLO
#define ARMA_DONT_PRINT_ERRORS
#include <armadillo>
#include <ctime>
#include <stdexcept>

namespace modebank::bench {
namespace {

template <class Mixture>
EmRun learn(Mixture mixture, const arma::mat& points, int iterations) {
  const std::clock_t start = std::clock();
  const bool learned =
      mixture.learn(points, mixture.n_gaus(), arma::maha_dist, arma::keep_existing, 0, iterations, 1e-300, false);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (!learned) throw std::runtime_error("Armadillo could not learn");
  return {seconds, arma::accu(mixture.log_p(points))};
}

}  // namespace

bool has_armadillo() { return true; }

EmRun run_armadillo(const EmCase& problem) {
  const auto F = static_cast<arma::uword>(problem.points.rows()),
             K = static_cast<arma::uword>(problem.start.components());
  const arma::mat points(const_cast<double*>(problem.points.data()), F, static_cast<arma::uword>(problem.points.cols()),
                         false, true);
  const arma::mat means(problem.start.means.data(), F, K);
  const arma::rowvec weights(problem.start.weights.data(), K);
  arma::cube full(F, F, K);
  arma::mat diagonal(F, K);
  for (arma::uword k = 0; k < K; ++k) {
    full.slice(k) = arma::mat(problem.start.covariances[k].data(), F, F);
    diagonal.col(k) = full.slice(k).diag();
  }
  if (problem.type == CovarianceType::full) {
    arma::gmm_full mixture;
    mixture.set_params(means, full, weights);
    return learn(mixture, points, problem.iterations);
  }
  arma::gmm_diag mixture;
  mixture.set_params(means, diagonal, weights);
  return learn(mixture, points, problem.iterations);
}

}  // namespace modebank::bench
#else
#include <stdexcept>

namespace modebank::bench {
bool has_armadillo() { return false; }
EmRun run_armadillo(const EmCase&) { throw std::logic_error("built without Armadillo"); }
}  // namespace modebank::bench
#endif
