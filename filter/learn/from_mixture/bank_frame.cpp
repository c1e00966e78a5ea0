#include "filter/learn/from_mixture/bank_frame.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

/// "wz", "wz[k-1]", ... A delay of 1 means that the newest sample is that of k; age -1 is written as [k+1].
std::vector<std::string> lagged_names(const std::vector<std::string>& names, Index lags, const InputDelays& delay) {
  std::vector<std::string> all;
  for (Index lag = 0; lag < lags; ++lag)
    for (Index j = 0; j < std::ssize(names); ++j) {
      const std::string& name = names[static_cast<std::size_t>(j)];
      const Index age = delay[j] - 1 + lag;
      all.push_back(age == 0 ? name : name + (age > 0 ? "[k-" + std::to_string(age) + "]" : "[k+1]"));
    }
  return all;
}

}  // namespace

std::vector<std::string> state_names(const Recording& recording, const LinearStructure& structure) {
  return lagged_names(names_of(recording.states), structure.state_lags, 1);
}

std::vector<std::string> input_names(const Recording& recording, const LinearStructure& structure) {
  return lagged_names(names_of(recording.inputs), structure.input_lags, structure.input_delay);
}

Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R) {
  check_structure(recording, structure);
  const Index n = structure.states;  // measured states
  if (R.rows() != n || R.cols() != n)
    throw std::invalid_argument("R is " + std::to_string(R.rows()) + " x " + std::to_string(R.cols()) + " for " +
                                std::to_string(n) + " states");
  Bank bank;
  bank.structure = structure;
  bank.C = Eigen::MatrixXd::Identity(n, structure.dimension());
  bank.R = R;
  bank.quantum = recording.quantum;
  bank.R = bank.recording_noise();
  bank.state_names = state_names(recording, structure);
  bank.input_names = input_names(recording, structure);
  bank.dt_s = training_part(recording).median_period_s();
  return bank;
}

Eigen::MatrixXd stated_or(const BankOptions& options, const Eigen::MatrixXd& R) {
  if (!options.measurement_variance) return R;
  return *options.measurement_variance * Eigen::MatrixXd::Identity(R.rows(), R.cols());
}

Mode make_mode(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& parameter_covariance, const Eigen::VectorXd& standard_error, double weight) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(structure.dimension(), structure.dimension());
  whole.topLeftCorner(structure.states, structure.states) = Q;
  return {unpack(structure, theta), whole, parameter_covariance, standard_error, weight};
}

void clear_unidentifiable(Bank& bank, const Eigen::MatrixXd& global_covariance) {
  const Eigen::VectorXd variance = global_covariance.diagonal();
  if (variance.array().isNaN().all()) return;
  for (Mode& mode : bank.modes)
    for (Eigen::Index j = 0; j < variance.size() && mode.standard_error.size() == variance.size(); ++j)
      if (std::isnan(variance(j))) mode.standard_error(j) = not_a_number;
}

void set_mode_sequence(Bank& bank, const TransitionMatrix& transition) {
  bank.transition = transition;
  const Index K = transition.modes();
  bank.initial_probability = Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K));
}

}  // namespace modebank
