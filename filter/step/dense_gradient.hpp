#pragma once

#include <Eigen/Core>

#include "filter/step/likelihood_gradient.hpp"

/// log_likelihood_gradient for any number of states, signals and modes. For some sizes vector kernels exist
/// (detail/vector/reverse.hpp); they are ten times faster.
namespace modebank {

/// True for `imm`, and for `kf` with one mode, if the noise is Gaussian with a constant scale.
bool has_dense_gradient(const Bank& bank, const FilterOptions& options);
/// Requires has_dense_gradient. Stores a hundred samples at a time. All samples except the last hundred are filtered
/// twice.
BankGradient dense_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
