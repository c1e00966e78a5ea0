#include "filter/bank_frame.hpp"

#include <stdexcept>
#include <string>

#include "filter/training_transitions.hpp"

namespace modebank {
namespace {}  // namespace

Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R) {
  check_structure(recording, structure);
  const Index n = structure.states;
  if (R.rows() != n || R.cols() != n)
    throw std::invalid_argument("R is " + std::to_string(R.rows()) + " x " + std::to_string(R.cols()) + " for " +
                                std::to_string(n) + " states");
  Bank bank;
  bank.structure = structure;
  bank.C = Eigen::MatrixXd::Identity(n, n);
  bank.R = R;
  bank.state_names = names_of(recording.states);
  bank.input_names = names_of(recording.inputs);
  bank.dt_s = training_part(recording).median_period_s();
  return bank;
}

void set_mode_sequence(Bank& bank, const TransitionMatrix& transition) {
  bank.transition = transition;
  const Index K = transition.modes();
  bank.initial_probability = Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K));
}

}  // namespace modebank
