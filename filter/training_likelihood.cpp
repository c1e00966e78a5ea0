#include "filter/training_likelihood.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Core>

namespace modebank {

double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options) {
  const Index runs = std::ssize(recording.runs);
  Eigen::VectorXd of_run = Eigen::VectorXd::Zero(runs);
  tbb::parallel_for(Index{0}, runs, [&](Index i) {
    if (recording.runs[i].role == Role::train) of_run(i) = log_likelihood(bank, recording.runs[i], options);
  });
  double sum = 0.0;
  for (const double value : of_run) sum += value;
  return sum;
}

}  // namespace modebank
