#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "modebank/ident/motion_model.hpp"

namespace modebank {

/// Facts that a model may need beyond what it estimates.
struct ModelSettings {
  Eigen::Index states = 1;
  Eigen::Index inputs = 2;
  double wheel_radius_m = 1.0;  ///< turns wheel speeds in rad/s into m/s; 1 for inputs that are m/s already
};

/// The models in ident/models, one header each, by the header's name.
std::vector<std::string> motion_model_names();

/// Throws ConfigurationError for an unknown name (says which exist) and for states or inputs that the model does not
/// have (says which it has).
std::shared_ptr<const MotionModel> make_motion_model(const std::string& name, const ModelSettings& settings);

}  // namespace modebank
