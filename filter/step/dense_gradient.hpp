#pragma once

#include <Eigen/Core>

#include "filter/step/likelihood_gradient.hpp"

/// log_likelihood_gradient for any number of states, signals and modes. If vector kernels exist for the sizes
/// (detail/vector/reverse.hpp), they are an order of magnitude faster.
namespace modebank {

/// True for imm, and for kf with one mode, with Gaussian noise of constant scale.
bool has_dense_gradient(const Bank& bank, const FilterOptions& options);
/// Requires has_dense_gradient. Stores a hundred samples at a time; all samples before the last hundred are filtered
/// twice.
BankGradient dense_gradient(const Bank& bank, const Trajectory& run, const Eigen::VectorXd& weight,
                            const FilterOptions& options);

}  // namespace modebank
