#include "ident/fit/motion_residuals.hpp"

#include <algorithm>
#include <cmath>

namespace modebank {

namespace {

double period_s(const Trajectory& run, Index k) { return run.time_s(k + 1) - run.time_s(k); }

/// Whether column k of the signals is finite. A plain loop is used, because a column has few entries.
bool finite_sample(const Eigen::MatrixXd& signals, Index k) {
  const double* const sample = signals.data() + k * signals.rows();
  return std::all_of(sample, sample + signals.rows(), [](double value) { return std::isfinite(value); });
}

bool finite_transition(const Trajectory& run, Index k) {
  return finite_sample(run.state, k) && finite_sample(run.state, k + 1) && finite_sample(run.input, k);
}

}  // namespace

std::vector<TransitionRange> training_stretches(const Recording& recording) {
  std::vector<TransitionRange> stretches;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) stretches.push_back({&run, 0, run.transitions()});
  return stretches;
}

ModelResiduals::ModelResiduals(const MotionModel& model, const std::vector<TransitionRange>& stretches,
                               const Eigen::VectorXd& weights)
    : model_(model) {
  std::vector<double> kept;
  Index position = 0, all = 0;
  for (const TransitionRange& s : stretches) all += s.length;
  kept.reserve(static_cast<std::size_t>(all));
  transitions_.reserve(static_cast<std::size_t>(all));
  for (const TransitionRange& s : stretches)
    for (Index k = s.start; k < s.start + s.length; ++k, ++position) {
      const double weight = weights.size() > 0 ? weights(position) : 1.0;
      if (!finite_transition(*s.run, k) || weight == 0.0) continue;
      kept.push_back(weight);
      transitions_.push_back({s.run->state.col(k).data(), s.run->input.col(k).data(), s.run->state.col(k + 1).data(),
                              period_s(*s.run, k)});
    }
  if (weights.size() > 0) weights_ = Eigen::Map<const Eigen::VectorXd>(kept.data(), samples());
}

Eigen::MatrixXd ModelResiduals::responses() const {
  Eigen::MatrixXd rows(samples(), states());
  Index row = 0;
  for (const MotionModel::Transition& t : transitions_) {
    const Eigen::Map<const Eigen::RowVectorXd> from(t.x, states()), to(t.next, states());
    rows.row(row++) = to - from;
  }
  return rows;
}

void ModelResiduals::evaluate(const double* theta, Eigen::VectorXd& r, RowMajorJacobian* J) const {
  r.resize(rows());
  if (J) J->resize(rows(), unknowns());
  evaluate(theta, 0, samples(), r.data(), J ? J->data() : nullptr);
}

void ModelResiduals::evaluate(const double* theta, Index first, Index count, double* r, double* J) const {
  model_.residuals(theta, transitions_.data() + first, count, r, J);
}

}  // namespace modebank
