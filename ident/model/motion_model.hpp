#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "modebank/ident/motion_model.hpp"

namespace modebank {

/// Constants that a model may need in addition to its estimated parameters.
struct ModelSettings {
  Eigen::Index states = 1;
  Eigen::Index inputs = 2;
  double wheel_radius_m = 1.0;  ///< converts wheel speeds from rad/s to m/s; 1 for inputs in m/s
};

/// The motion models of the folder ident/model/models, by name.
std::vector<std::string> motion_model_names();

/// Throws ConfigurationError for an unknown name; the message lists the known names. Also throws it if the states or
/// inputs do not fit the model; the message lists the model's states and inputs.
std::shared_ptr<const MotionModel> make_motion_model(const std::string& name, const ModelSettings& settings);

}  // namespace modebank
