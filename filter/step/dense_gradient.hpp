#pragma once

#include <Eigen/Core>

#include "filter/step/likelihood_gradient.hpp"

/// log_likelihood_gradient of any number of states, signals and modes, one mode included. The sizes that have vector
/// kernels (detail/vector/reverse.hpp) are an order of magnitude faster there.
namespace modebank {

/// The imm, and kf of one mode, with Gaussian noise of constant scale.
bool has_dense_gradient(const Bank& bank, const FilterOptions& options);
/// Requires has_dense_gradient. A hundred samples are kept at a time; those before the last
/// hundred are filtered twice.
BankGradient dense_gradient(const Bank& bank, const Trajectory& run, const Eigen::VectorXd& weight,
                            const FilterOptions& options);

}  // namespace modebank
