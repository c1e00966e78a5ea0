#pragma once

#include <Eigen/Core>
#include <random>
#include <string>

#include "ident/simulate/simulate.hpp"

namespace modebank {

/// Parts that the simulated systems share. The checks throw ConfigurationError with the name of the value.
void require_setting(bool ok, const std::string& message);
void require_nonnegative_setting(double value, const std::string& name);
void require_fraction_setting(double value, const std::string& name);
void check_commands(const CommandOptions& options);
void check_runs(Index runs, double dt_s);

/// Run names "00", "01", ... All have the number of digits of the last run, at least two, so that names in byte order
/// are in run order.
std::string simulated_run_name(Index run, Index runs);

/// Draws `size` values of N(0, sd^2).
Eigen::VectorXd draw_noise(Index size, double sd, std::mt19937_64& generator);

struct Outliers {
  double fraction = 0.0, sd = 0.0;
};

/// Adds noise to every sample (column), with one standard deviation per row, and outliers to some samples.
void add_noise(Eigen::MatrixXd& samples, const Eigen::VectorXd& sd, const Outliers& outliers,
               std::mt19937_64& generator);

}  // namespace modebank
