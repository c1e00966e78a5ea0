#include "ident/simulate/simulation_parts.hpp"

#include <algorithm>
#include <boost/random/bernoulli_distribution.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>

#include "modebank/base/error.hpp"

namespace modebank {

void require_setting(bool ok, const std::string& message) {
  if (!ok) throw ConfigurationError("simulation: " + message);
}

void require_nonnegative_setting(double value, const std::string& name) {
  require_setting(value >= 0.0 && std::isfinite(value),
                  name + " = " + std::to_string(value) + " is negative or not finite");
}

void require_fraction_setting(double value, const std::string& name) {
  require_setting(value >= 0.0 && value <= 1.0, name + " = " + std::to_string(value) + " is outside 0..1");
}

void check_commands(const CommandOptions& o) {
  require_setting(o.samples >= 2, "samples = " + std::to_string(o.samples) + " is below 2");
  require_setting(o.hold_samples >= 1, "hold_samples = " + std::to_string(o.hold_samples) + " is below 1");
  require_nonnegative_setting(o.input_amplitude, "input_amplitude");
  require_nonnegative_setting(o.input_quantum, "input_quantum");
  require_fraction_setting(o.standstill_fraction, "standstill_fraction");
  require_fraction_setting(o.equal_fraction, "equal_fraction");
  require_fraction_setting(o.standstill_fraction + o.equal_fraction, "standstill_fraction + equal_fraction");
}

void check_runs(Index runs, double dt_s) {
  require_setting(runs >= 1, "runs = " + std::to_string(runs) + " is below 1");
  require_setting(dt_s > 0.0 && std::isfinite(dt_s), "dt_s = " + std::to_string(dt_s) + " is not positive");
}

std::string simulated_run_name(Index run, Index runs) {
  const std::size_t width = std::max<std::size_t>(2, std::to_string(runs - 1).size());
  const std::string digits = std::to_string(run);
  return std::string(width - digits.size(), '0') + digits;
}

Eigen::VectorXd draw_noise(Index size, double sd, std::mt19937_64& generator) {
  boost::random::normal_distribution<double> standard;
  Eigen::VectorXd noise(size);
  for (double& value : noise) value = sd * standard(generator);
  return noise;
}

void add_noise(Eigen::MatrixXd& samples, const Eigen::VectorXd& sd, const Outliers& outliers,
               std::mt19937_64& generator) {
  boost::random::bernoulli_distribution<double> is_outlier(outliers.fraction);
  for (Index k = 0; k < samples.cols(); ++k) {
    samples.col(k) += sd.cwiseProduct(draw_noise(samples.rows(), 1.0, generator));
    const bool outlier = is_outlier(generator);
    const Eigen::VectorXd error = draw_noise(samples.rows(), outliers.sd, generator);
    if (outlier) samples.col(k) += error;
  }
}

}  // namespace modebank
