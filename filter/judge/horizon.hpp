#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/noise_density.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

/// Predictions along a recorded run: some samples ahead from every sample, and free runs.
namespace modebank {

/// Predictions of one run at several horizons, from the measurements up to the origin and the inputs recorded since.
/// Column k belongs to sample k. NaN if no filter was running at the origin, or if the measurement is incomplete.
struct HorizonEvaluation {
  std::vector<Eigen::Index> horizons;  ///< samples ahead, ascending
  std::vector<Eigen::MatrixXd> error;  ///< per horizon n_y x N: measurement minus combined prediction
  std::vector<Eigen::MatrixXd> pit;    ///< per horizon n_y x N: P(y_i <= measurement) of each signal by itself
  Eigen::MatrixXd log_density;         ///< horizons x N: log predictive density of the measurement [nats]
};

/// An empty evaluation, its horizons sorted. Throws std::invalid_argument for a horizon below 1.
HorizonEvaluation empty_horizons(std::vector<Eigen::Index> horizons, Eigen::Index n_y, Eigen::Index samples);

/// Horizon 1 equals evaluate_run, whose conditions hold. A sample costs one step per sample of the longest horizon.
HorizonEvaluation evaluate_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                    std::vector<Eigen::Index> horizons);

/// Errors of predictions by running noise with J levels, N columns. NaN where HorizonEvaluation has NaN.
struct LevelErrors {
  Eigen::MatrixXd whitened;    ///< J n_y x N: errors divided by their standard deviations, and decorrelated in order
  Eigen::MatrixXd log_weight;  ///< J x N: log of a level's probability divided by those deviations

  /// Gain of a sample's log density from a variance that is multiplied by `factor` [nats].
  double widening_gain(const StudentNoise& noise, Eigen::Index k, double factor) const;
};

/// The errors at each horizon, by the variances before any horizon factor. Requires running noise.
std::vector<LevelErrors> level_errors(const Bank& bank, const Trajectory& run,
                                      const std::vector<Eigen::Index>& horizons);

struct FreeRunOptions {
  Eigen::Index samples = 0;  ///< number of measured samples at the beginning; 0 turns free runs off
  Eigen::Index paths = 400;  ///< number of sample paths, for banks that need them
  std::uint64_t seed = 1;    ///< seed of the paths; each run derives its own generator from its name

  bool operator==(const FreeRunOptions&) const = default;
};

/// Smallest number of measured samples that a model can start from.
inline Eigen::Index fewest_start_samples(const LinearStructure& structure) { return structure.first_transition() + 1; }

/// Predictions of a run from its first samples and the inputs alone. Column k belongs to sample k; a value is NaN (a
/// mode is -1) if the sample was not predicted. The free run restarts after each gap at which filters restart.
struct FreeRun {
  Eigen::MatrixXd mean;            ///< n_y x N
  Eigen::MatrixXd deviation;       ///< n_y x N, standard deviation of the measurement about `mean`
  Eigen::MatrixXd lower, upper;    ///< n_y x N, central 95 % band
  Eigen::MatrixXd pit;             ///< n_y x N, as in HorizonEvaluation; NaN unless the measurement is complete
  Eigen::VectorXd log_density;     ///< N, joint log density of the measurement [nats]
  Eigen::VectorXi mode;            ///< N, most probable mode
  Eigen::Index lost_paths = 0;     ///< number of paths that diverged and were removed
  std::vector<std::string> notes;  ///< reasons for missing predictions
};

/// By the moments of every mode, which are exact for a constant transition matrix; bands and densities treat every
/// mode's distribution, and all levels of running noise, as Gaussian. Banks whose transitions depend on the state need
/// SamplePaths. Conditions are those of evaluate_run; std::invalid_argument for fewer samples than the model needs.
FreeRun free_run(const Bank& bank, const Trajectory& run, const FilterOptions& filter, const FreeRunOptions& options);

}  // namespace modebank
