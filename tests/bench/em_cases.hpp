#pragma once

#include <Eigen/Core>
#include <string>

#include "mixture/gaussian_mixture.hpp"

namespace modebank::bench {

/// One comparison: points, the start all programs share, and a fixed number of iterations.
struct EmCase {
  std::string name;
  CovarianceType type = CovarianceType::full;
  int iterations = 10;
  Eigen::MatrixXd points;  ///< F x N
  GaussianMixture start;
};

/// What a program made of a case: seconds for all iterations, and the log-likelihood it ended with.
struct EmRun {
  double seconds = 0.0;
  double log_likelihood = 0.0;
};

/// Armadillo's gmm_full or gmm_diag; one thread. Not there when the benchmark was built without it.
bool has_armadillo();
EmRun run_armadillo(const EmCase& problem);

}  // namespace modebank::bench
