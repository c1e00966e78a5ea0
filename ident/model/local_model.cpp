#include "ident/model/local_model.hpp"

#include <cmath>

#include "ident/base/not_a_number.hpp"

namespace modebank {

Index WindowFits::parameter_count() const {
  return model_parameters.empty() ? structure.parameters() : static_cast<Index>(model_parameters.size());
}

std::vector<std::string> WindowFits::parameter_names() const {
  if (model_parameters.empty()) return structure.parameter_names();
  std::vector<std::string> names;
  for (const ModelParameter& parameter : model_parameters) names.push_back(parameter.name);
  return names;
}

void WindowFits::resize(Index windows_count) {
  const Index p = parameter_count();
  windows.resize(static_cast<std::size_t>(windows_count));
  parameters.resize(p, windows_count);
  covariance.resize(p * p, windows_count);
  noise_variance.resize(structure.states, windows_count);
  condition.resize(windows_count);
  rank.resize(windows_count);
  information.resize(p, windows_count);
  inlier_fraction.resize(windows_count);
  status.resize(windows_count);
  r_squared.resize(structure.states, windows_count);
  transitions.resize(windows_count);
  weighed_information.resize(structure.states, windows_count);
}

void WindowFits::set(Index i, const LocalModel& fit) {
  parameters.col(i) = fit.theta;
  covariance.col(i) = fit.covariance.reshaped();
  noise_variance.col(i) = fit.noise_variance;
  condition(i) = fit.condition;
  rank(i) = static_cast<int>(fit.rank);
  information.col(i) = fit.information;
  inlier_fraction(i) = fit.inlier_fraction;
  status(i) = static_cast<int>(fit.status);
  if (fit.r_squared.size() > 0)
    r_squared.col(i) = fit.r_squared;
  else
    r_squared.col(i).setConstant(not_a_number);
  transitions(i) = static_cast<int>(fit.transitions);
  if (fit.weighed_information.size() > 0)
    weighed_information.col(i) = fit.weighed_information;
  else
    weighed_information.col(i).setConstant(not_a_number);
}

LocalModel WindowFits::at(Index i) const {
  const Index p = parameter_count();
  LocalModel fit;
  fit.theta = parameters.col(i);
  fit.covariance = covariance.col(i).reshaped(p, p);
  fit.noise_variance = noise_variance.col(i);
  fit.condition = condition(i);
  fit.rank = rank(i);
  fit.information = information.col(i);
  fit.inlier_fraction = inlier_fraction(i);
  fit.status = static_cast<FitStatus>(status(i));
  if (r_squared.cols() > 0) fit.r_squared = r_squared.col(i);
  fit.transitions = transitions.size() > 0 ? transitions(i) : length;
  if (weighed_information.cols() > 0) fit.weighed_information = weighed_information.col(i);
  return fit;
}

Eigen::MatrixXd WindowFits::standard_errors() const {
  const Index p = parameter_count();
  Eigen::MatrixXd errors(p, count());
  const bool known = global.covariance.rows() == p && !global.covariance.diagonal().array().isNaN().all();
  for (Index j = 0; j < p; ++j) {
    if (known && std::isnan(global.covariance(j, j)))
      errors.row(j).setConstant(not_a_number);
    else
      errors.row(j) = covariance.row(j * (p + 1)).cwiseSqrt();
  }
  return errors;
}

Eigen::MatrixXd WindowFits::t_values() const { return parameters.cwiseQuotient(standard_errors()); }

}  // namespace modebank
