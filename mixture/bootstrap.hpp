#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mixture/select.hpp"

namespace modebank {

/// For every row the column assigned to it, one to one, such that the sum of the chosen values is largest. `values`
/// K x K, finite. Shortest augmenting paths (Jonker & Volgenant 1987, Computing 38), K^3 operations.
std::vector<Eigen::Index> best_assignment(const Eigen::MatrixXd& values);

/// Standard errors of weights and means by the bootstrap (Efron 1979) over whole runs, since windows of one run are not
/// independent: runs are drawn with replacement, EM starts from the chosen mixture, and its components are matched one
/// to one with the chosen ones' (assignment of largest total overlap of responsibilities), so that exchanged labels do
/// not count as error. Times sqrt(R / (R - 1)) for R runs, as a sample standard deviation. NaN for fewer than two runs,
/// and for the mean of a component that fewer than half of the resamples contain (with a weight above one point's).
/// `runs` N, the run of each point; replicates >= 2.
MixtureErrors bootstrap_runs(const PointSet& points, const std::vector<Eigen::Index>& runs,
                             const GaussianMixture& mixture, const EmOptions& options, int replicates,
                             std::uint64_t seed);

}  // namespace modebank
