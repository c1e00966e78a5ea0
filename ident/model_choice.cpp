#include "ident/model_choice.hpp"

#include "ident/error.hpp"

namespace modebank {

void check_model(const FitOptions& options, Index states, Index inputs) {
  const bool lags = options.state_lags != 1 || options.input_lags != 1 || options.input_delay != 1;
  if (lags && options.model != "varx")
    throw ConfigurationError("window.state_lags, input_lags and input_delay are those of window.model = varx, not of " +
                             options.model);
  if (options.model == "varx" && options.residual == ResidualKind::simulation)
    throw ConfigurationError("window.residual = simulation does not simulate window.model = varx");
  motion_model(options, states, inputs);
}

std::shared_ptr<const MotionModel> motion_model(const FitOptions& options, Index states, Index inputs) {
  if (is_linear(options)) return nullptr;
  return make_motion_model(options.model, {states, inputs, options.wheel_radius_m});
}

Index parameter_count(const FitOptions& options, Index states, Index inputs) {
  const auto motion = motion_model(options, states, inputs);
  return motion ? motion->parameter_count() : linear_structure(states, inputs, options).parameters();
}

}  // namespace modebank
