#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "filter/step/bank.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Which share of the time a bank whose switches see state and input is in each mode, if these stay at `z`: what is
/// stationary under T there. K.
Eigen::VectorXd settled_shares(const Bank& bank, const Eigen::VectorXd& z);

/// Which states and inputs belong to which mode, over the one or two features that move the switches most, others at
/// their training mean; with the samples that the bank was run on. Null for a bank of constant T.
nlohmann::json guard_of(const Archive& archive);

}  // namespace modebank::app::report
