#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "filter/bank_frame.hpp"
#include "filter/learn.hpp"
#include "filter/noise_floor.hpp"
#include "filter/noise_parameters.hpp"
#include "filter/training_likelihood.hpp"
#include "filter/training_transitions.hpp"
#include "ident/error.hpp"

namespace modebank {
namespace {

constexpr double smallest_r_share = 1e-10;    // of var(y) (method: section 5)
constexpr double bound_tolerance = 1e-7;      // nats per sample that R at its bound may cost
constexpr double difference_step = 1e-5;      // of log coordinates: truncation and rounding both near 1e-10
constexpr double stationary_gradient = 1e-5;  // nats per sample and unit of a log coordinate
constexpr double least_gain = 1e-9;           // nats per sample: a better start has to be better than rounding
constexpr std::array<std::pair<double, double>, 2> noise_starts{{{1.0, 0.1}, {0.01, 0.5}}};  // shares of Q, R

/// A point of the search and the mean log-likelihood per sample there.
struct NoiseEstimate {
  NoiseParametrisation parametrisation;
  Eigen::VectorXd coordinates;
  double mean_log_likelihood = -std::numeric_limits<double>::infinity();
  bool stationary = false;
};

/// Of the measured states; lagged samples have none.
void set_process_noise(Bank& bank, const Eigen::MatrixXd& Q) {
  bank.modes.front().Q.topLeftCorner(Q.rows(), Q.cols()) = Q;
}

/// Minus the mean log-likelihood per sample as Ceres minimises it, with gradient by central differences.
class NoiseObjective final : public ceres::FirstOrderFunction {
 public:
  NoiseObjective(Bank bank, const Recording& training, NoiseParametrisation parametrisation)
      : bank_(std::move(bank)),
        training_(training),
        parametrisation_(std::move(parametrisation)),
        samples_(static_cast<double>(training.transitions(Role::train))) {}

  int NumParameters() const override { return static_cast<int>(parametrisation_.size()); }

  bool Evaluate(const double* coordinates, double* cost, double* gradient) const override {
    *cost = value(coordinates);
    if (!std::isfinite(*cost)) return false;
    if (!gradient) return true;
    Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(coordinates, parametrisation_.size());
    for (Index i = 0; i < at.size(); ++i) {
      const double center = at(i);
      at(i) = center + difference_step;
      const double above = value(at.data());
      at(i) = center - difference_step;
      gradient[i] = (above - value(at.data())) / (2.0 * difference_step);
      at(i) = center;
      if (!std::isfinite(gradient[i])) return false;
    }
    return true;
  }

 private:
  double value(const double* coordinates) const {
    Bank bank = bank_;
    const NoiseCovariances noise = parametrisation_.decode(coordinates);
    set_process_noise(bank, noise.Q);
    bank.R = noise.R;
    return -training_log_likelihood(bank, training_, {FilterVariant::kf, false}) / samples_;
  }

  Bank bank_;
  const Recording& training_;
  NoiseParametrisation parametrisation_;
  double samples_;
};

NoiseEstimate maximise(const Bank& bank, const Recording& training, NoiseEstimate start) {
  ceres::GradientProblem problem(new NoiseObjective(bank, training, start.parametrisation));
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 200;
  options.gradient_tolerance = 1e-7;
  options.function_tolerance = 1e-13;
  options.parameter_tolerance = 1e-10;
  ceres::GradientProblemSolver::Summary summary;
  NoiseEstimate end = std::move(start);
  ceres::Solve(options, problem, end.coordinates.data(), &summary);

  double cost = 0.0;
  Eigen::VectorXd gradient(end.coordinates.size());
  if (!problem.Evaluate(end.coordinates.data(), &cost, gradient.data())) return end;
  end.mean_log_likelihood = -cost;
  end.stationary = gradient.cwiseAbs().maxCoeff() <= stationary_gradient;
  return end;
}

/// The likelihood can have one maximum with the noise in Q and another with it in R: the best of several starts.
NoiseEstimate best_of_starts(const Bank& bank, const Recording& training, const NoiseParametrisation& parametrisation) {
  std::optional<NoiseEstimate> best;
  for (const auto& [q_share, r_share] : noise_starts) {
    NoiseEstimate end = maximise(bank, training, {parametrisation, parametrisation.coordinates(q_share, r_share)});
    if (!best || end.mean_log_likelihood > best->mean_log_likelihood + least_gain) best = std::move(end);
  }
  return *best;
}

/// Holds every output's R at its bound where that costs no likelihood.
NoiseEstimate hold_at_bounds(const Bank& bank, const Recording& training, NoiseEstimate best, Index outputs) {
  for (Index i = 0; i < outputs; ++i) {
    NoiseEstimate held =
        maximise(bank, training, {best.parametrisation.hold(i), best.parametrisation.without(best.coordinates, i)});
    if (held.mean_log_likelihood >= best.mean_log_likelihood - bound_tolerance) best = std::move(held);
  }
  return best;
}

/// Lower bound of R's diagonal: its share of each output's population variance over the training samples.
Eigen::VectorXd measurement_bound(const Recording& training) {
  const Index n = training.state_count();
  Eigen::VectorXd bound(n);
  for (Index i = 0; i < n; ++i) {
    double count = 0.0, mean = 0.0, scatter = 0.0;  // Welford's recursion
    for (const Trajectory& run : training.runs)
      for (const double y : run.state.row(i)) {
        if (!std::isfinite(y)) continue;
        const double delta = y - mean;
        mean += delta / ++count;
        scatter += delta * (y - mean);
      }
    bound(i) = count > 0.0 ? smallest_r_share * scatter / count : 0.0;
  }
  return bound;
}

}  // namespace

Baseline learn_baseline(const Recording& recording, const GlobalModel& global, const LinearStructure& structure) {
  const Recording training = training_part(recording);
  if (training.transitions(Role::train) == 0) throw DataError("no training run has a transition to learn from");
  const Index n = structure.states, p = structure.parameters();
  Baseline baseline;
  baseline.bank = bank_frame(recording, structure, Eigen::MatrixXd::Zero(n, n));
  baseline.bank.modes.push_back(make_mode(structure, global.theta, global.residual_covariance,
                                          Eigen::MatrixXd::Zero(p, p), global.covariance.diagonal().cwiseSqrt(), 1.0));
  set_mode_sequence(baseline.bank, TransitionMatrix());

  const NoiseParametrisation parametrisation(global.noise_variance().unaryExpr(&positive_variance),
                                             measurement_bound(training));
  const NoiseEstimate best =
      hold_at_bounds(baseline.bank, training, best_of_starts(baseline.bank, training, parametrisation), n);
  const NoiseCovariances noise = best.parametrisation.decode(best.coordinates.data());
  set_process_noise(baseline.bank, noise.Q);
  baseline.bank.R = noise.R;
  baseline.log_likelihood = training_log_likelihood(baseline.bank, training, {FilterVariant::kf, false});
  baseline.converged = best.stationary;
  for (Index i = 0; i < n; ++i) baseline.at_bound = baseline.at_bound || best.parametrisation.held(i);
  return baseline;
}

}  // namespace modebank
