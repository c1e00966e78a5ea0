#include "filter/learn/likelihood/maximum_likelihood.hpp"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/step/likelihood_gradient.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

constexpr double step_share = 1e-2;       // step of central differences, as a share of a standard error
constexpr double first_step = 1e-3;       // step of central differences until standard errors are known
constexpr double least_curvature = 1e-2;  // curvature added to every coordinate, because some may be undetermined
constexpr double remaining_gain = 1e-3;   // nats
constexpr Index iterations_per_metric = 40;
constexpr Index fewest_metric_samples = 1000,
                samples_per_coordinate = 5;  // a metric needs no standard error's accuracy

bool is_finite(const Bank& bank) {
  return bank.R.allFinite() && bank.transition.matrix().allFinite() &&
         std::all_of(bank.modes.begin(), bank.modes.end(), [](const Mode& mode) {
           return mode.Q.allFinite() && mode.model.A.allFinite() && mode.model.B.allFinite() &&
                  mode.model.c.allFinite();
         });
}

/// The gradient of training_log_likelihood. Requires has_likelihood_gradient (filter/step).
BankGradient training_gradient(const Bank& bank, const Recording& recording, const FilterOptions& options) {
  std::vector<const Trajectory*> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) runs.push_back(&run);
  std::vector<BankGradient> of_run(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { of_run[i] = log_likelihood_gradient(bank, *runs[i], options); });
  for (std::size_t i = 1; i < of_run.size(); ++i) of_run[0] += of_run[i];
  return std::move(of_run.at(0));
}

struct Slope {
  double value = -std::numeric_limits<double>::infinity();
  Eigen::VectorXd gradient = {};
};

/// The target function near one bank.
class Neighbourhood {
 public:
  Neighbourhood(const LikelihoodTarget& target, const FreeParameters& free, const Bank& origin,
                const Eigen::VectorXd& steps)
      : target_(target),
        coordinates_(origin, free),
        steps_(steps.size() > 0 ? steps : Eigen::VectorXd::Constant(coordinates_.size(), first_step)) {}

  Index size() const { return coordinates_.size(); }
  Bank decode(const Eigen::VectorXd& at) const { return coordinates_.decode(at); }
  double value(const Eigen::VectorXd& at) const { return target_.value(decode(at)); }

  /// The target and its gradient. Uses the adjoint of the filter's steps if it exists, else differences.
  Slope slope(const Eigen::VectorXd& at) const {
    const Bank bank = decode(at);
    if (!is_finite(bank)) return {};
    if (!is_exact())
      return {target_.value(bank), differences(at, [this](const Bank& other) { return target_.value(other); })};
    const BankGradient by_bank = training_gradient(bank, target_.recording, target_.filter);
    Slope result{by_bank.log_likelihood + target_.log_prior(bank), Eigen::VectorXd(size())};
    tbb::parallel_for(Index{0}, size(), [&](Index c) {
      const Eigen::VectorXd step = steps_(c) * Eigen::VectorXd::Unit(size(), c);
      const Bank up = decode(at + step), down = decode(at - step);
      const double rise = by_bank.along(down, up) + target_.log_prior(up) - target_.log_prior(down);
      result.gradient(c) = rise / (2.0 * steps_(c));
    });
    return result;
  }

  /// Gradient and information of likelihood and prior at the origin. The search uses the same gradient. So this
  /// gradient vanishes where the search ends.
  SampleGradients gradients() const {
    const Eigen::VectorXd origin = Eigen::VectorXd::Zero(size());
    SampleGradients result;
    if (is_exact()) {
      const InformationSamples samples(target_.recording,
                                       std::max(fewest_metric_samples, samples_per_coordinate * size()));
      const Recording& part = samples.part ? *samples.part : target_.recording;
      result = sample_gradients(coordinates_, steps_, part, target_.filter);
      result.sum = slope(origin).gradient;
      result.information *= samples.factor;
    } else {
      result = sample_gradients(coordinates_, steps_, target_.recording, target_.filter);
      result.sum += differences(origin, [this](const Bank& bank) { return target_.log_prior(bank); });
    }
    if (target_.prior) result.information += prior_information(coordinates_, *target_.prior);
    return result;
  }

 private:
  const LikelihoodTarget& target_;
  BankCoordinates coordinates_;
  Eigen::VectorXd steps_;

  bool is_exact() const { return has_likelihood_gradient(coordinates_.origin(), target_.filter); }

  template <class Value>
  Eigen::VectorXd differences(const Eigen::VectorXd& at, Value value) const {
    Eigen::VectorXd result(size());
    tbb::parallel_for(Index{0}, size(), [&](Index c) {
      const Eigen::VectorXd step = steps_(c) * Eigen::VectorXd::Unit(size(), c);
      result(c) = (value(decode(at + step)) - value(decode(at - step))) / (2.0 * steps_(c));
    });
    return result;
  }
};

/// Minus the target, relative to its value at the origin. Ceres minimises it. Coordinates are in units of standard
/// errors.
class WhitenedTarget final : public ceres::FirstOrderFunction {
 public:
  WhitenedTarget(const Neighbourhood& around, Eigen::MatrixXd by_standard_errors, double origin_value)
      : around_(around), by_(std::move(by_standard_errors)), origin_value_(origin_value) {}

  int NumParameters() const override { return static_cast<int>(by_.rows()); }

  bool Evaluate(const double* whitened, double* cost, double* gradient) const override {
    const Eigen::VectorXd at = by_ * Eigen::Map<const Eigen::VectorXd>(whitened, by_.rows());
    if (!gradient) {
      *cost = origin_value_ - around_.value(at);
      return std::isfinite(*cost);
    }
    const Slope slope = around_.slope(at);
    *cost = origin_value_ - slope.value;
    if (!std::isfinite(*cost)) return false;
    Eigen::Map<Eigen::VectorXd> result(gradient, by_.rows());
    result = -(by_.transpose() * slope.gradient);
    return result.allFinite();
  }

 private:
  const Neighbourhood& around_;
  Eigen::MatrixXd by_;
  double origin_value_;
};

/// The gradient at a bank, and the standard errors that serve as units.
struct Metric {
  Eigen::VectorXd steps;               ///< steps of central differences for the rest of the search
  Eigen::MatrixXd by_standard_errors;  ///< matrix that maps whitened coordinates to coordinates
  Eigen::VectorXd gradient;            ///< gradient with respect to whitened coordinates

  /// Expected gain of a Newton step.
  double expected_gain() const { return 0.5 * gradient.squaredNorm(); }
};

std::optional<Metric> metric_of(const SampleGradients& gradients) {
  Eigen::MatrixXd information = gradients.information;
  information.diagonal().array() += least_curvature;
  if (!information.allFinite() || !gradients.sum.allFinite()) return std::nullopt;
  const Cholesky factor(information);
  if (!factor.definite()) return std::nullopt;
  return Metric{step_share * information.diagonal().cwiseSqrt().cwiseInverse(), factor.inverse_root(),
                factor.whiten(gradients.sum)};
}

struct BfgsEnd {
  Eigen::VectorXd at;
  Index iterations = 0;
  double expected_gain = 0.0;  ///< expected gain of a Newton step at the end, with the metric at the beginning
};

/// `small_gain`: the search ends if the expected gain is below this value.
BfgsEnd bfgs(const Neighbourhood& nearby, const Metric& metric, double origin_value, double small_gain, Index limit) {
  const ceres::GradientProblem problem(new WhitenedTarget(nearby, metric.by_standard_errors, origin_value));
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = static_cast<int>(std::min(iterations_per_metric, limit));
  options.gradient_tolerance = 0.5 * std::sqrt(2.0 * small_gain / static_cast<double>(nearby.size()));
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-8;
  ceres::GradientProblemSolver::Summary summary;
  Eigen::VectorXd at = Eigen::VectorXd::Zero(nearby.size());
  ceres::Solve(options, problem, at.data(), &summary);
  const double slope = summary.iterations.back().gradient_norm;
  return {metric.by_standard_errors * at, std::max<Index>(std::ssize(summary.iterations) - 1, 1), 0.5 * slope * slope};
}

}  // namespace

double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options) {
  std::vector<double> of_run(recording.runs.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, of_run.size(), [&](std::size_t i) {
    if (recording.runs[i].role == Role::train) of_run[i] = log_likelihood(bank, recording.runs[i], options);
  });
  return std::accumulate(of_run.begin(), of_run.end(), 0.0);
}

double LikelihoodTarget::value(const Bank& bank) const {
  if (!is_finite(bank)) return -std::numeric_limits<double>::infinity();
  return training_log_likelihood(bank, recording, filter) + log_prior(bank);
}

double LikelihoodTarget::log_prior(const Bank& bank) const {
  return prior ? modebank::log_prior(*prior, one_theta, switching_model(bank)) : 0.0;
}

LikelihoodMaximum maximise_likelihood(const LikelihoodTarget& target, const FreeParameters& free, const Bank& start,
                                      const AscentLimits& limits) {
  const double transitions = static_cast<double>(target.recording.transitions(Role::train));
  const double small_gain = std::min(remaining_gain, limits.tolerance * transitions);
  Eigen::VectorXd steps;
  LikelihoodMaximum best{start, target.value(start)};
  if (!std::isfinite(best.value)) return best;
  while (true) {
    const std::optional<Metric> metric = metric_of(Neighbourhood(target, free, best.bank, steps).gradients());
    if (!metric) return best;
    if (steps.size() == 0 && !(best.value + metric->expected_gain() > limits.least_value)) best.end = MeasuredFit::none;
    if (best.end == MeasuredFit::none) return best;
    if (metric->expected_gain() <= small_gain)
      best.end = MeasuredFit::converged;
    else if (best.iterations >= limits.max_iterations)
      best.end = MeasuredFit::iteration_limit;
    best.rose = best.rose || best.end == MeasuredFit::converged;
    if (best.end != MeasuredFit::stalled) return best;
    steps = metric->steps;
    const Neighbourhood nearby(target, free, best.bank, steps);
    const BfgsEnd end = bfgs(nearby, *metric, best.value, small_gain, limits.max_iterations - best.iterations);
    best.iterations += end.iterations;
    Bank next = nearby.decode(end.at);
    const double value = target.value(next);
    if (!(value > best.value)) return best;
    best.bank = std::move(next);
    best.value = value;
    best.rose = true;
    // A new metric costs two filter passes per coordinate; a gradient costs three passes in total.
    if (end.expected_gain <= small_gain) {
      best.end = MeasuredFit::converged;
      return best;
    }
  }
}

}  // namespace modebank
