#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// A log-likelihood, and its derivatives by the numbers of a bank. In a symmetric matrix, each entry has its own.
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
  /// Difference of the log-likelihoods of two banks that differ a little in these parts, to first order.
  double along(const Bank& from, const Bank& to) const;
};

/// Whether the gradient is available for this filter.
bool has_likelihood_gradient(const Bank& bank, const FilterOptions& options);

/// The exact gradient of the sum of log_densities (bank_filter.hpp) of one run, where has_likelihood_gradient. It costs
/// a few filter passes (reverse-mode differentiation; Griewank & Walther 2008, "Evaluating derivatives").
BankGradient log_likelihood_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
