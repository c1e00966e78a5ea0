#include "filter/learn/from_mixture/training_transitions.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

#include "modebank/base/error.hpp"

namespace modebank {

void check_structure(const Recording& recording, const LinearStructure& s) {
  if (recording.state_count() == s.states && recording.input_count() == s.inputs) return;
  throw std::invalid_argument("the model has " + std::to_string(s.states) + " states and " + std::to_string(s.inputs) +
                              " inputs, the recording " + std::to_string(recording.state_count()) + " and " +
                              std::to_string(recording.input_count()));
}

void require_transitions(bool any) {
  if (!any) throw DataError("no training run has a usable transition (two successive samples without missing values)");
}

TrainingTransitions gather_training_transitions(const Recording& recording, const LinearStructure& structure) {
  check_structure(recording, structure);
  const Index N = recording.transitions(Role::train);
  const Transitions rows{Eigen::MatrixXd(N, structure.regressors()), Eigen::MatrixXd(N, structure.states)};
  TrainingTransitions all{structure, rows, Eigen::VectorXd::Ones(N), {}};
  Index first = 0;
  for (Index r = 0; r < std::ssize(recording.runs); ++r) {
    const Trajectory& run = recording.runs[r];
    if (run.role != Role::train) continue;
    all.runs.push_back({r, first, run.transitions()});
    const Transitions of_run = stack_transitions(run, 0, run.transitions(), structure);
    all.data.regressors.middleRows(first, run.transitions()) = of_run.regressors;
    all.data.increments.middleRows(first, run.transitions()) = of_run.increments;
    first += run.transitions();
  }
  for (Index k = 0; k < N; ++k) {
    if (all.data.regressors.row(k).allFinite() && all.data.increments.row(k).allFinite()) continue;
    all.data.regressors.row(k).setZero();
    all.data.increments.row(k).setZero();
    all.usable(k) = 0.0;
  }
  require_transitions(all.usable.sum() > 0.0);
  return all;
}

RegressionSums RegressionSums::operator+(const RegressionSums& other) const {
  return {G + other.G, H + other.H, S + other.S, weight + other.weight};
}

Eigen::MatrixXd RegressionSums::scatter_after(const Eigen::MatrixXd& change) const {
  const Eigen::MatrixXd cross = change.transpose() * H;
  return S - cross - cross.transpose() + change.transpose() * G * change;
}

Eigen::VectorXd sum_by_run(const TrainingTransitions& transitions, const Eigen::VectorXd& rows) {
  Eigen::VectorXd sums(std::ssize(transitions.runs));
  for (Index r = 0; r < sums.size(); ++r) {
    const RunRows& run = transitions.runs[r];
    sums(r) = rows.segment(run.first, run.count).sum();
  }
  return sums;
}

RegressionSums regression_sums(const Eigen::MatrixXd& regressors, const Eigen::VectorXd& weights,
                               const Eigen::MatrixXd& residuals) {
  constexpr double negligible = 1e-12;  // in any mode, most transitions have a smaller weight and are skipped
  const Index q = regressors.cols(), n = residuals.cols();
  std::vector<Index> rows;
  for (Index k = 0; k < weights.size(); ++k)
    if (weights(k) > negligible) rows.push_back(k);
  const Eigen::VectorXd root = weights(rows).cwiseSqrt();
  Eigen::MatrixXd scaled(std::ssize(rows), q + n), gram = Eigen::MatrixXd::Zero(q + n, q + n);
  for (Index c = 0; c < q; ++c) scaled.col(c) = root.cwiseProduct(regressors.col(c)(rows));
  for (Index c = 0; c < n; ++c) scaled.col(q + c) = root.cwiseProduct(residuals.col(c)(rows));
  gram.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return {gram.topLeftCorner(q, q), gram.topRightCorner(q, n), gram.bottomRightCorner(n, n), weights.sum()};
}

Recording training_part(const Recording& recording) {
  Recording training{recording.states, recording.inputs, {}, recording.quantum};
  std::copy_if(recording.runs.begin(), recording.runs.end(), std::back_inserter(training.runs),
               [](const Trajectory& run) { return run.role == Role::train; });
  return training;
}

}  // namespace modebank
