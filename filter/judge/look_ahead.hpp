#pragma once

#include <Eigen/Core>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// What learning that looks ahead counts: of every sample the mean of its log predictive densities 1, 2, ... h samples
/// ahead [nats], a composite likelihood (Varin, Reid & Firth 2011, Statistica Sinica 21(1)); N, NaN where a filter
/// scores nothing. A sample has fewer predictions near a run's start: what is missing counts as nothing. Neighbouring
/// origins say nearly the same, so that beyond one sample ahead every look_ahead_stride(h)-th is taken, for all of
/// them. h = 1 is log_densities. Conditions of evaluate_run; h at least 1, else std::invalid_argument.
Eigen::VectorXd look_ahead_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                     Eigen::Index h);

/// Their sum over a run; h = 1 is log_likelihood, bit for bit.
double look_ahead_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options, Eigen::Index h);

/// Samples from one origin to the next: a quarter of the farthest horizon, rounded up.
inline Eigen::Index look_ahead_stride(Eigen::Index h) { return (h + 3) / 4; }

}  // namespace modebank
