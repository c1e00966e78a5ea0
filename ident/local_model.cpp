#include "ident/local_model.hpp"

namespace modebank {

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
  return fit;
}

}  // namespace modebank
