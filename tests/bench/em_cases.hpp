#pragma once

#include <Eigen/Core>
#include <string>

#include "mixture/gaussian_mixture.hpp"

namespace modebank::bench {

/// One case of the comparison: points, the start that all programs share, and a fixed number of iterations.
struct EmCase {
  std::string name;
  CovarianceType type = CovarianceType::full;
  int iterations = 10;
  Eigen::MatrixXd points;  ///< F x N
  GaussianMixture start;
};

/// Result of one program for one case: seconds for all iterations, and the final log-likelihood.
struct EmRun {
  double seconds = 0.0;
  double log_likelihood = 0.0;
};

/// Armadillo's gmm_full or gmm_diag on one thread. Unavailable if the benchmark was built without Armadillo.
bool has_armadillo();
EmRun run_armadillo(const EmCase& problem);

}  // namespace modebank::bench
