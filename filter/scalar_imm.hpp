#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "ident/trajectory.hpp"

/// The interacting multiple model filter of one state measured by one signal, several modes or several runs per vector
/// register (Highway, chosen for the machine at run time). It computes what FilterStep computes, to rounding: the same
/// mixing, floors and treatment of impossible modes, in another order of summation.
namespace modebank::scalar_imm {

/// A bank laid out for the kernels.
struct Parameters {
  Eigen::Index modes = 0, inputs = 0;
  double C = 1.0, R = 0.0;
  Eigen::VectorXd F, c, Q;      ///< K, F = 1 + A
  Eigen::MatrixXd B;            ///< K x m
  Eigen::MatrixXd transition;   ///< K x K
  Eigen::VectorXd probability;  ///< K, at the start, floored
  double start_gain = 1.0, start_variance = 0.0;

  explicit Parameters(const Bank& bank);
};

/// One run from its start on: sample 0 is the start, transition k leads from sample k to k + 1.
struct Samples {
  const double* measurement = nullptr;  ///< count; NaN: missing, but for the first
  const double* inputs = nullptr;       ///< m x (count - 1), one transition per column
  Eigen::Index count = 0;
};

/// Whether the kernels can step this bank in this way.
bool can_step(const Bank& bank, const FilterOptions& options);
/// Whether they can take this run: one step per sample, no new start.
bool can_take(const Bank& bank, const Trajectory& run, const FilterOptions& options);

/// Sum of log predictive densities over a run.
double log_likelihood(const Parameters& bank, const Samples& samples);

/// The same of many runs, each with its own bank of the same number of modes and inputs.
struct Job {
  const Parameters* bank = nullptr;
  Samples samples;
};
std::vector<double> log_likelihoods(const std::vector<Job>& jobs);

}  // namespace modebank::scalar_imm
