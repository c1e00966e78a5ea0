#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// A log-likelihood, and its derivatives with respect to all numbers of a bank on which it depends. Each number has its
/// own derivative. For a symmetric matrix, each entry has its own.
struct BankGradient {
  struct Mode {
    LinearModel model;
    Eigen::MatrixXd Q;
  };
  double log_likelihood = 0.0;
  std::vector<Mode> modes;
  Eigen::MatrixXd R;
  Eigen::MatrixXd transition;
  Eigen::MatrixXd start_covariance;  ///< derivative with respect to the covariance of start_moments

  BankGradient& operator+=(const BankGradient& other);
  /// Difference of the log-likelihoods of two similar banks, to first order. The banks may differ only in the parts
  /// listed above.
  double along(const Bank& from, const Bank& to) const;
};

/// Whether the gradient is available for this filter.
bool has_likelihood_gradient(const Bank& bank, const FilterOptions& options);

/// The gradient of sum_k log p(y_k | earlier) of one run. It is the exact derivative of the filter's
/// computation. It costs a few filter passes for any number of parameters (reverse-mode differentiation; Griewank &
/// Walther 2008, "Evaluating derivatives"). The conditions are those of log_likelihood (filter/judge/evaluate.hpp)
/// and has_likelihood_gradient.
BankGradient log_likelihood_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
