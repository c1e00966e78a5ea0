#include "ident/model/parameter_labels.hpp"

#include <algorithm>

namespace modebank {

namespace {

/// The name without the suffix "[k-1]" or "[k+1]" of a bank's lagged names.
std::string channel_name(const std::string& name) {
  // Position of the suffix; 0 without a suffix
  const std::size_t sample = std::max(name.rfind("[k-") + 1, name.rfind("[k+") + 1);
  return sample > 0 && name.back() == ']' ? name.substr(0, sample - 1) : name;
}

std::vector<std::string> channel_names(const std::vector<std::string>& names, Eigen::Index count, char otherwise) {
  std::vector<std::string> result;
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto i = static_cast<std::size_t>(j);
    result.push_back(i < names.size() ? channel_name(names[i]) : otherwise + std::to_string(j + 1));
  }
  return result;
}

}  // namespace

std::vector<std::string> regressor_labels(const LinearStructure& s, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs) {
  const std::vector<std::string> x = channel_names(states, s.states, 'x'), u = channel_names(inputs, s.inputs, 'u');
  std::vector<std::string> labels;
  const auto add = [&](const std::vector<std::string>& names, Eigen::Index lags, const InputDelays& first) {
    for (Eigen::Index lag = 0; lag < lags; ++lag)
      for (Eigen::Index j = 0; j < std::ssize(names); ++j)
        labels.push_back(names[static_cast<std::size_t>(j)] +
                         (s.lagged() ? " (lag " + std::to_string(first[j] + lag) + ")" : ""));
  };
  add(x, s.state_lags, 1);
  add(u, s.input_lags, s.input_delay);
  return labels;
}

std::vector<std::string> parameter_labels(const LinearStructure& s, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs) {
  const std::vector<std::string> regressors = regressor_labels(s, states, inputs);
  std::vector<std::string> labels;
  for (const std::string& row : channel_names(states, s.states, 'x')) {
    for (const std::string& regressor : regressors) labels.push_back(row + " <- " + regressor);
    if (s.intercept) labels.push_back(row + " <- 1");
  }
  return labels;
}

std::vector<std::string> parameter_labels(const WindowFits& fits, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs) {
  return fits.model_parameters.empty() ? parameter_labels(fits.structure, states, inputs) : fits.parameter_names();
}

}  // namespace modebank
