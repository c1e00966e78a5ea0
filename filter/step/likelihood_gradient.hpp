#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// Derivatives of a log-likelihood by everything about a bank that it depends on, each number for itself; of symmetric
/// matrices by each of their entries.
struct BankGradient {
  struct Mode {
    LinearModel model;
    Eigen::MatrixXd Q;
  };
  std::vector<Mode> modes;
  Eigen::MatrixXd R;
  Eigen::MatrixXd transition;
  Eigen::MatrixXd start_covariance;  ///< of start_moments

  BankGradient& operator+=(const BankGradient& other);
  /// What it says the likelihood of a bank close by has more than that of another. Of the two only what is listed above
  /// may differ.
  double along(const Bank& from, const Bank& to) const;
};

/// Whether there is a gradient of what this filter says.
bool has_likelihood_gradient(const Bank& bank, const FilterOptions& options);

/// The gradient of sum_k weight_k log p(y_k | earlier) of one run, exact for what the filter computes, at the cost of a
/// few filter passes, however many parameters there are: the steps are gone back over in reverse (reverse mode of
/// differentiation; Griewank & Walther 2008, "Evaluating derivatives"). `weight`: one per sample, or empty: all one.
/// Conditions are those of log_likelihood (filter/judge/run/evaluate.hpp) and has_likelihood_gradient.
BankGradient log_likelihood_gradient(const Bank& bank, const Trajectory& run, const Eigen::VectorXd& weight,
                                     const FilterOptions& options);

}  // namespace modebank
