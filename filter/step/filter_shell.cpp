#include "filter/step/filter_shell.hpp"

#include "ident/base/not_a_number.hpp"

namespace modebank {

FilterShell::FilterShell(const Bank& bank) : feed(bank), initial_probability(bank.initial_probability) {
  const Eigen::Index n = bank.structure.dimension(), n_y = bank.C.rows();
  estimate.prediction.resize(n);
  estimate.innovation.resize(n_y);
  estimate.innovation_covariance.resize(n_y, n_y);
  estimate.state.resize(n);
  estimate.covariance.resize(n, n);
  estimate.pit.resize(n_y);
  estimate.pit_width.setZero(n_y);
  wait();
}

void FilterShell::restart() {
  started = false;
  feed.clear();
}

void FilterShell::clear_prediction() {
  estimate.prediction.setConstant(not_a_number);
  estimate.innovation_covariance.setConstant(not_a_number);
  estimate.steps = 0;
  clear_scores();
}

void FilterShell::clear_scores() {
  estimate.innovation.setConstant(not_a_number);
  estimate.pit.setConstant(not_a_number);
  estimate.pit_width.setZero();
  estimate.nis = estimate.log_density = not_a_number;
}

void FilterShell::wait() {
  clear_prediction();
  estimate.state.setConstant(not_a_number);
  estimate.covariance.setConstant(not_a_number);
  estimate.mode_probability_predicted = initial_probability;
  estimate.mode_probability = initial_probability;
}

}  // namespace modebank
