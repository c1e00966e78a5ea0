#include "ident/fit/motion_residuals.hpp"

#include <algorithm>
#include <cmath>

namespace modebank {

namespace {

double period_s(const Trajectory& run, Index k) { return run.time_s(k + 1) - run.time_s(k); }

/// Column k of signals, entry by entry: there are few.
bool finite_sample(const Eigen::MatrixXd& signals, Index k) {
  const double* const sample = signals.data() + k * signals.rows();
  return std::all_of(sample, sample + signals.rows(), [](double value) { return std::isfinite(value); });
}

bool finite_transition(const Trajectory& run, Index k) {
  return finite_sample(run.state, k) && finite_sample(run.state, k + 1) && finite_sample(run.input, k);
}

double sample_weight(const Trajectory& run, Index k) { return run.weight.size() > 0 ? run.weight(k) : 1.0; }

/// Whether a simulation is compared with sample k.
bool compared(const Trajectory& run, Index k) { return run.state.col(k).allFinite() && sample_weight(run, k) > 0.0; }

/// Cuts what lies before the first measured sample off: a simulation has to start somewhere.
Stretch from_first_measured(Stretch s) {
  while (s.length > 0 && !s.run->state.col(s.start).allFinite()) {
    ++s.start;
    --s.length;
  }
  return s;
}

}  // namespace

std::vector<Stretch> training_stretches(const Recording& recording) {
  std::vector<Stretch> stretches;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) stretches.push_back({&run, 0, run.transitions()});
  return stretches;
}

ModelResiduals::ModelResiduals(const MotionModel& model, const std::vector<Stretch>& stretches, ResidualKind kind,
                               const Eigen::VectorXd& weights)
    : model_(model), kind_(kind) {
  if (kind == ResidualKind::one_step)
    take_transitions(stretches, weights);
  else
    take_simulations(stretches);
}

void ModelResiduals::take_transitions(const std::vector<Stretch>& stretches, const Eigen::VectorXd& weights) {
  std::vector<double> kept;
  Index position = 0, all = 0;
  for (const Stretch& s : stretches) all += s.length;
  kept.reserve(static_cast<std::size_t>(all));
  transitions_.reserve(static_cast<std::size_t>(all));
  for (const Stretch& s : stretches)
    for (Index k = s.start; k < s.start + s.length; ++k, ++position) {
      const double weight = weights.size() > 0 ? weights(position) : sample_weight(*s.run, k + 1);
      if (!finite_transition(*s.run, k) || weight == 0.0) continue;
      kept.push_back(weight);
      transitions_.push_back({s.run->state.col(k).data(), s.run->input.col(k).data(), s.run->state.col(k + 1).data(),
                              period_s(*s.run, k)});
    }
  samples_ = static_cast<Index>(transitions_.size());
  if (weights.size() > 0)
    weights_ = Eigen::Map<const Eigen::VectorXd>(kept.data(), samples_);
  else
    take_run_weights(kept);
}

void ModelResiduals::take_simulations(const std::vector<Stretch>& stretches) {
  std::vector<double> kept;
  for (const Stretch& given : stretches) {
    const Stretch s = from_first_measured(given);
    if (s.length < 1) continue;
    stretches_.push_back(s);
    initial_states_.conservativeResize(initial_states_.size() + states());
    initial_states_.tail(states()) = s.run->state.col(s.start);
    for (Index k = s.start; k <= s.start + s.length; ++k)
      if (compared(*s.run, k)) kept.push_back(sample_weight(*s.run, k));
  }
  samples_ = static_cast<Index>(kept.size());
  take_run_weights(kept);
}

void ModelResiduals::take_run_weights(const std::vector<double>& weights) {
  if (std::all_of(weights.begin(), weights.end(), [](double w) { return w == 1.0; })) return;
  weights_ = Eigen::Map<const Eigen::VectorXd>(weights.data(), samples_);
  weights_ /= weights_.mean();
}

Eigen::MatrixXd ModelResiduals::responses() const {
  Eigen::MatrixXd rows(samples_, states());
  Index row = 0;
  for (const MotionModel::Transition& t : transitions_) {
    const Eigen::Map<const Eigen::RowVectorXd> from(t.x, states()), to(t.next, states());
    rows.row(row++) = to - from;
  }
  for (const Stretch& s : stretches_)
    for (Index k = s.start; k <= s.start + s.length; ++k)
      if (compared(*s.run, k)) rows.row(row++) = s.run->state.col(k).transpose();
  if (weights_.size() > 0) rows.array().colwise() *= weights_.array().sqrt();
  return rows;
}

Eigen::VectorXd ModelResiduals::unknowns_at(const Eigen::VectorXd& theta) const {
  Eigen::VectorXd all(unknowns());
  all << theta, initial_states_;
  return all;
}

void ModelResiduals::evaluate(const double* unknowns, Eigen::VectorXd& r, RowMajorJacobian* J) const {
  r.resize(rows());
  if (J) J->resize(rows(), this->unknowns());
  if (kind_ == ResidualKind::one_step)
    one_step(unknowns, r, J);
  else
    simulate(unknowns, r, J);
}

void ModelResiduals::one_step(const double* theta, Eigen::VectorXd& r, RowMajorJacobian* J) const {
  model_.residuals(theta, transitions_.data(), samples_, r.data(), J ? J->data() : nullptr);
}

void ModelResiduals::simulate(const double* unknowns, Eigen::VectorXd& r, RowMajorJacobian* J) const {
  const Index n = states(), p = model_.parameter_count();
  Index row = 0, first_state = p;
  Eigen::VectorXd x(n), next(n);
  RowMajorJacobian sensitivity(n, this->unknowns()), by_theta(n, p), by_x(n, n);
  for (const Stretch& s : stretches_) {
    x = Eigen::Map<const Eigen::VectorXd>(unknowns + first_state, n);
    sensitivity.setZero();
    sensitivity.middleCols(first_state, n).setIdentity();
    first_state += n;
    for (Index k = s.start;; ++k) {
      if (compared(*s.run, k)) {
        r.segment(row, n) = s.run->state.col(k) - x;
        if (J) J->middleRows(row, n) = sensitivity;
        row += n;
      }
      if (k == s.start + s.length) break;
      model_.predict(unknowns, x.data(), s.run->input.col(k).data(), period_s(*s.run, k), next.data(),
                     J ? by_theta.data() : nullptr, J ? by_x.data() : nullptr);
      x = next;
      if (!J) continue;
      sensitivity = (by_x * sensitivity).eval();
      sensitivity.leftCols(p) += by_theta;
    }
  }
}

}  // namespace modebank
