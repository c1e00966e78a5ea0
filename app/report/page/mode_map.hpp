#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "filter/step/bank.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Share of the time in each mode (K) while states and inputs stay at `z`, for state-dependent transitions: the
/// stationary distribution of T at z.
Eigen::VectorXd settled_shares(const Bank& bank, const Eigen::VectorXd& z);

/// Map of the modes over the one or two features with the largest effect on the transitions; other features are at
/// their training mean. With the samples on which the bank ran. Null for a constant T.
nlohmann::json mode_map_of(const Archive& archive);

}  // namespace modebank::app::report
