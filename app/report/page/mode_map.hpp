#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "filter/step/bank.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Share of time in each mode (K) if states and inputs stay at `z`: the stationary distribution of T at z. For
/// state-dependent transition probabilities.
Eigen::VectorXd settled_shares(const Bank& bank, const Eigen::VectorXd& z);

/// Map of the modes over the one or two features with the largest effect on the transitions. Other features are at
/// their training mean. Contains the samples on which the bank ran. Null for a constant T.
nlohmann::json mode_map_of(const Archive& archive);

}  // namespace modebank::app::report
