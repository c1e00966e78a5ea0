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

/// Throws ConfigurationError for an unknown name, with a list of the names. Also throws it for states or inputs that do
/// not fit the model, with a list of those that fit.
std::shared_ptr<const MotionModel> make_motion_model(const std::string& name, const ModelSettings& settings);

}  // namespace modebank
