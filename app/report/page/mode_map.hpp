#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "filter/step/bank.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Share of time in each mode (K) while states and inputs stay at `z`. It is the stationary distribution of T at z, for
/// state-dependent transition probabilities.
Eigen::VectorXd settled_shares(const Bank& bank, const Eigen::VectorXd& z);

/// Map of the modes over the one or two features with the largest effect on the transitions. All other features are at
/// their training means. The map contains the samples that the bank has filtered. Null for a constant T.
nlohmann::json mode_map_of(const Archive& archive);

}  // namespace modebank::app::report
