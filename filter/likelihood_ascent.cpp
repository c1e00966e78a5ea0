#include "filter/likelihood_ascent.hpp"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "filter/bank_coordinates.hpp"
#include "filter/refine_start.hpp"
#include "filter/switching_state_space.hpp"
#include "filter/training_likelihood.hpp"

namespace modebank {
namespace {

constexpr double step_share = 1e-2;       // of a standard error, for central differences
constexpr double first_step = 1e-3;       // while no standard errors are known
constexpr double least_curvature = 1e-2;  // of a coordinate that the data say nothing about: such are logarithms
constexpr double remaining_gain = 1e-3;   // nats
constexpr Index iterations_per_metric = 15;

/// Zero where there is no density.
Eigen::MatrixXd weighted(const Trajectory& run, double unit, const Eigen::MatrixXd& of_samples) {
  const Eigen::MatrixXd known = of_samples.array().isNaN().select(0.0, of_samples);
  return run.weight.size() > 0 ? Eigen::MatrixXd(run.weight.asDiagonal() * known / unit) : known;
}

/// The target around one bank.
class Neighbourhood {
 public:
  Neighbourhood(const LikelihoodTarget& target, const Bank& origin, const Eigen::MatrixXd& theta_unit,
                const Eigen::VectorXd& steps)
      : target_(target),
        coordinates_(origin, target.shared, theta_unit, target.estimate_R ? target.least_R : Eigen::VectorXd()),
        steps_(steps.size() > 0 ? steps : Eigen::VectorXd::Constant(coordinates_.size(), first_step)) {}

  Index size() const { return coordinates_.size(); }
  Bank decode(const Eigen::VectorXd& at) const { return coordinates_.decode(at); }
  double value(const Eigen::VectorXd& at) const { return target_.value(decode(at)); }

  Eigen::VectorXd gradient(const Eigen::VectorXd& at) const {
    Eigen::VectorXd result(size());
    tbb::parallel_for(Index{0}, size(), [&](Index c) {
      result(c) = (value(moved(at, c, 1.0)) - value(moved(at, c, -1.0))) / (2.0 * steps_(c));
    });
    return result;
  }

  struct Scores {
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information;
  };
  /// At the origin.
  Scores scores() const {
    const Eigen::VectorXd origin = Eigen::VectorXd::Zero(size());
    Scores result = prior_scores();
    const double unit = mean_training_weight(target_.recording);
    for (const Trajectory& run : target_.recording.runs) {
      if (run.role != Role::train || run.samples() < 2) continue;
      Eigen::MatrixXd of_run(run.samples(), size());
      tbb::parallel_for(Index{0}, size(), [&](Index c) {
        const Bank above = decode(moved(origin, c, 1.0)), below = decode(moved(origin, c, -1.0));
        of_run.col(c) =
            (log_densities(above, run, target_.filter) - log_densities(below, run, target_.filter)) / (2.0 * steps_(c));
      });
      of_run = weighted(run, unit, of_run);
      result.gradient += of_run.colwise().sum().transpose();
      result.information.noalias() += of_run.transpose() * of_run;
    }
    return result;
  }

 private:
  const LikelihoodTarget& target_;
  BankCoordinates coordinates_;
  Eigen::VectorXd steps_;

  Eigen::VectorXd moved(Eigen::VectorXd at, Index c, double by) const {
    at(c) += by * steps_(c);
    return at;
  }
  double log_prior_at(const Eigen::VectorXd& at) const {
    return log_prior(target_.prior, target_.shared, switching_model(decode(at)));
  }
  Scores prior_scores() const {
    const Eigen::VectorXd origin = Eigen::VectorXd::Zero(size());
    const double here = log_prior_at(origin);
    Scores result{Eigen::VectorXd(size()), Eigen::MatrixXd::Zero(size(), size())};
    for (Index c = 0; c < size(); ++c) {
      const double above = log_prior_at(moved(origin, c, 1.0)), below = log_prior_at(moved(origin, c, -1.0));
      result.gradient(c) = (above - below) / (2.0 * steps_(c));
      result.information(c, c) = std::max(0.0, (2.0 * here - above - below) / (steps_(c) * steps_(c)));
    }
    return result;
  }
};

/// Minus the target as Ceres minimises it, from the value at the origin on; coordinates in standard errors.
class WhitenedTarget final : public ceres::FirstOrderFunction {
 public:
  WhitenedTarget(const Neighbourhood& around, Eigen::MatrixXd by_standard_errors, double origin_value)
      : around_(around), by_(std::move(by_standard_errors)), origin_value_(origin_value) {}

  int NumParameters() const override { return static_cast<int>(by_.rows()); }

  bool Evaluate(const double* whitened, double* cost, double* gradient) const override {
    const Eigen::VectorXd at = by_ * Eigen::Map<const Eigen::VectorXd>(whitened, by_.rows());
    *cost = origin_value_ - around_.value(at);
    if (!std::isfinite(*cost)) return false;
    if (!gradient) return true;
    Eigen::Map<Eigen::VectorXd> result(gradient, by_.rows());
    result = -(by_.transpose() * around_.gradient(at));
    return result.allFinite();
  }

 private:
  const Neighbourhood& around_;
  Eigen::MatrixXd by_;
  double origin_value_;
};

/// Standard errors of theta given the modes and states: as units good enough.
Eigen::MatrixXd theta_units(const LikelihoodTarget& target, const Bank& bank) {
  const SwitchingSums sums = smooth_states(bank, target.recording, target.prior, target.filter.time_steps).switching;
  const std::vector<Eigen::MatrixXd> covariances = parameter_covariances(sums, target.prior, switching_model(bank));
  Eigen::MatrixXd units(bank.structure.parameters(), bank.mode_count());
  for (Index j = 0; j < units.cols(); ++j)
    units.col(j) =
        covariances[static_cast<std::size_t>(j)].diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  return units;
}

/// The gradient at a bank in units of the standard errors.
struct Metric {
  Eigen::VectorXd steps;               ///< of central differences from now on
  Eigen::MatrixXd by_standard_errors;  ///< coordinates from whitened ones
  Eigen::VectorXd gradient;            ///< by whitened ones

  /// Of a Newton step.
  double expected_gain() const { return 0.5 * gradient.squaredNorm(); }
};

Metric metric_of(const Neighbourhood::Scores& scores) {
  Eigen::MatrixXd information = scores.information;
  information.diagonal().array() += least_curvature;
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  return {step_share * information.diagonal().cwiseSqrt().cwiseInverse(),
          factor.matrixU().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols())),
          factor.matrixL().solve(scores.gradient)};
}

/// `small_gain`: what no more is to be gained by.
Index climb(const Neighbourhood& nearby, const Metric& metric, double origin_value, double small_gain, Index limit,
            Eigen::VectorXd& at) {
  const ceres::GradientProblem problem(new WhitenedTarget(nearby, metric.by_standard_errors, origin_value));
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = static_cast<int>(std::min(iterations_per_metric, limit));
  options.gradient_tolerance = 0.5 * std::sqrt(2.0 * small_gain / static_cast<double>(nearby.size()));
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-8;
  ceres::GradientProblemSolver::Summary summary;
  at.setZero(nearby.size());
  ceres::Solve(options, problem, at.data(), &summary);
  at = metric.by_standard_errors * at;
  return std::max<Index>(std::ssize(summary.iterations) - 1, 1);
}

}  // namespace

double LikelihoodTarget::value(const Bank& bank) const {
  const double prior_value = log_prior(prior, shared, switching_model(bank));
  if (!recording.weighted()) return training_log_likelihood(bank, recording, filter) + prior_value;
  const double unit = mean_training_weight(recording);
  double sum = 0.0;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) sum += weighted(run, unit, log_densities(bank, run, filter)).sum();
  return sum + prior_value;
}

Ascent raise_likelihood(const LikelihoodTarget& target, const AscentLimits& limits, Bank& bank) {
  const double transitions = static_cast<double>(target.recording.transitions(Role::train));
  const double small_gain = std::min(remaining_gain, limits.tolerance * transitions);
  const Eigen::MatrixXd units = theta_units(target, bank);
  Eigen::VectorXd steps;
  Ascent result;
  result.value = target.value(bank);
  while (true) {
    const Neighbourhood::Scores scores = Neighbourhood(target, bank, units, steps).scores();
    if (!scores.information.allFinite() || !scores.gradient.allFinite()) return result;
    const Metric metric = metric_of(scores);
    if (metric.expected_gain() <= small_gain)
      result.end = MeasuredFit::converged;
    else if (result.iterations >= limits.max_iterations)
      result.end = MeasuredFit::iteration_limit;
    if (result.end != MeasuredFit::stalled) return result;
    steps = metric.steps;
    const Neighbourhood nearby(target, bank, units, steps);
    Eigen::VectorXd at;
    result.iterations += climb(nearby, metric, result.value, small_gain, limits.max_iterations - result.iterations, at);
    const Bank next = nearby.decode(at);
    const double value = target.value(next);
    if (!(value > result.value)) return result;
    bank = next;
    result.value = value;
  }
}

}  // namespace modebank
