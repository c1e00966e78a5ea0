#include "filter/learn/likelihood/maximum_likelihood.hpp"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>

#include "filter/judge/evaluate.hpp"
#include "filter/step/likelihood_gradient.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr double jacobian_step = 1e-4;    // of central differences of the coordinates' exponentials; the error is 2e-9
constexpr double step_share = 1e-2;       // step of central differences, as a share of a standard error
constexpr double first_step = 1e-3;       // step of central differences until standard errors are known
constexpr double least_curvature = 1e-2;  // curvature added to every coordinate, because some may be undetermined
constexpr double remaining_gain = 1e-3;   // nats; a twentieth of a standard error
constexpr Index iterations_per_metric = 40;
constexpr Index fewest_metric_samples = 1000, samples_per_coordinate = 5;  // a metric may be rough

double bounded_exp(double z) { return std::exp(std::clamp(z, -30.0, 30.0)); }

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

/// Minus the target near a bank, relative to its value there, in units of standard errors. Ceres minimises it.
class NearbyTarget final : public ceres::FirstOrderFunction {
 public:
  /// `steps`: those of central differences until standard errors are known.
  NearbyTarget(const LikelihoodTarget& target, const BankCoordinates& around, double origin_value,
               Eigen::VectorXd steps)
      : target_(target), around_(around), origin_value_(origin_value), steps_(std::move(steps)) {}

  int NumParameters() const override { return static_cast<int>(around_.size()); }
  const Eigen::VectorXd& steps() const { return steps_; }
  Bank decode(const double* whitened) const {
    return around_.decode(by_standard_errors_ * Eigen::VectorXd::Map(whitened, around_.size()));
  }

  /// Sets units and steps from the standard errors. Returns the expected gain of a Newton step; NaN if a number is not
  /// finite.
  double set_units() {
    const Index most = std::max(fewest_metric_samples, samples_per_coordinate * around_.size());
    Eigen::VectorXd gradient;
    evaluate(Eigen::VectorXd::Zero(around_.size()), gradient);
    Eigen::MatrixXd information = observed_information(target_, around_, steps_, most);
    information.diagonal().array() += least_curvature;
    if (!information.allFinite() || !gradient.allFinite()) return not_a_number;
    const Cholesky factor(information);
    if (!factor.definite()) return not_a_number;
    steps_ = step_share * information.diagonal().cwiseSqrt().cwiseInverse();
    by_standard_errors_ = factor.inverse_root();
    return 0.5 * factor.whiten(gradient).squaredNorm();
  }

  bool Evaluate(const double* whitened, double* cost, double* gradient) const override {
    if (!gradient) {
      *cost = origin_value_ - target_.value(decode(whitened));
      return std::isfinite(*cost);
    }
    const Eigen::VectorXd at = by_standard_errors_ * Eigen::VectorXd::Map(whitened, around_.size());
    Eigen::VectorXd by_coordinates;
    *cost = origin_value_ - evaluate(at, by_coordinates);
    Eigen::VectorXd::Map(gradient, around_.size()) = -(by_standard_errors_.transpose() * by_coordinates);
    return std::isfinite(*cost) && by_coordinates.allFinite();
  }

 private:
  /// The value of the target and its gradient, by the adjoint of the filter's steps if it exists, else by central
  /// differences. NaN if the bank is not finite.
  double evaluate(const Eigen::VectorXd& at, Eigen::VectorXd& gradient) const {
    gradient.setConstant(around_.size(), not_a_number);
    const Bank bank = around_.decode(at);
    if (!is_finite(bank)) return not_a_number;
    std::optional<BankGradient> by_bank;
    if (has_likelihood_gradient(bank, target_.filter))
      by_bank = training_gradient(bank, target_.recording, target_.filter);
    tbb::parallel_for(Index{0}, around_.size(), [&](Index c) {
      const Eigen::VectorXd step = steps_(c) * Eigen::VectorXd::Unit(around_.size(), c);
      const Bank up = around_.decode(at + step), down = around_.decode(at - step);
      const double rise = by_bank ? by_bank->along(down, up) + target_.log_prior(up) - target_.log_prior(down)
                                  : target_.value(up) - target_.value(down);
      gradient(c) = rise / (2.0 * steps_(c));
    });
    return by_bank ? by_bank->log_likelihood + target_.log_prior(bank) : target_.value(bank);
  }

  const LikelihoodTarget& target_;
  const BankCoordinates& around_;
  double origin_value_;
  Eigen::VectorXd steps_;
  Eigen::MatrixXd by_standard_errors_;
};

/// Moves `bank` to the end of a search that stops where the expected gain is below `small_gain`. Returns the iterations
/// and the expected gain of a Newton step at the end, with the units at the beginning.
std::pair<Index, double> bfgs(std::unique_ptr<NearbyTarget> nearby, double small_gain, Index limit, Bank& bank) {
  const NearbyTarget& around = *nearby;
  const ceres::GradientProblem problem(nearby.release());
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = static_cast<int>(std::min(iterations_per_metric, limit));
  options.gradient_tolerance = 0.5 * std::sqrt(2.0 * small_gain / around.NumParameters());
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-8;
  ceres::GradientProblemSolver::Summary summary;
  Eigen::VectorXd at = Eigen::VectorXd::Zero(around.NumParameters());
  ceres::Solve(options, problem, at.data(), &summary);
  const double slope = summary.iterations.back().gradient_norm;
  bank = around.decode(at.data());
  return {std::max<Index>(std::ssize(summary.iterations) - 1, 1), 0.5 * slope * slope};
}

const double* set_process_noise(const double* at, const FreeParameters& free, Bank& bank) {
  const Index n = bank.structure.states, L = bank.noise_levels, K = bank.mode_count();
  std::vector<double> factor(L, 1.0);  // of each level's Q, relative to the first one's
  for (Index l = 1; l < L; ++l) factor[l] = bank.modes[l].Q(0, 0) / bank.modes[0].Q(0, 0);
  for (Index first = 0; first < K; first += L) {
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a, ++at) M(a, b) = a == b ? bounded_exp(*at) : *at;
    auto Q = bank.modes[first].Q.topLeftCorner(n, n);
    const Eigen::MatrixXd root = Cholesky(Q).L() * M;
    Q.noalias() = root * root.transpose();
    if (free.least_Q.size() > 0) Q.diagonal() = Q.diagonal().cwiseMax(free.least_Q);
  }
  for (Index l = 1; l < L; ++l, ++at)
    for (Index first = 0; first < K; first += L)
      bank.modes[first + l].Q = factor[l] * bounded_exp(*at) * bank.modes[first].Q;
  return at;
}

/// The matrix with rows moved from `at`, which goes on.
Eigen::MatrixXd moved_rows(Eigen::MatrixXd T, const double*& at) {
  for (Index i = 0; i < T.rows(); ++i) {
    Index largest = 0;
    T.row(i).maxCoeff(&largest);
    for (Index j = 0; j < T.cols(); ++j)
      if (j != largest) T(i, j) *= bounded_exp(*at++);
    T.row(i) /= T.row(i).sum();
  }
  return T;
}

void set_transition(const double* at, Bank& bank) {
  const auto [of_motions, of_levels] = chains_of(bank.transition.matrix(), bank.noise_levels);
  const Eigen::MatrixXd T = moved_rows(of_motions, at);
  bank.transition = TransitionMatrix(Eigen::kroneckerProduct(T, moved_rows(of_levels, at)).eval());
}

/// The free parameters of a bank, in the order of BankCoordinates::jacobian.
Eigen::VectorXd parameters_of(const Bank& bank, const FreeParameters& free) {
  std::vector<double> all;
  const auto append = [&](const Eigen::VectorXd& values) { all.insert(all.end(), values.begin(), values.end()); };
  for (Index j = 0; j < bank.mode_count(); ++j) {
    if (free.theta_unit.size() > 0) append(bank.theta(j));
    for (Index b = 0; b < bank.structure.states; ++b)
      append(bank.modes[j].Q.col(b).segment(b, bank.structure.states - b));
    if (free.transition) append(bank.transition.matrix().row(j));
  }
  append(bank.R.diagonal()(free.R));
  return Eigen::VectorXd::Map(all.data(), std::ssize(all));
}

}  // namespace

BankCoordinates::BankCoordinates(Bank origin, FreeParameters free)
    : origin_(std::move(origin)), free_(std::move(free)) {}

Index BankCoordinates::size() const {
  const Index n = origin_.structure.states, L = origin_.noise_levels, M = origin_.mode_count() / L;
  const Index noise = M * n * (n + 1) / 2 + L - 1, switches = M * (M - 1) + L * (L - 1);
  return free_.theta_unit.size() + noise + std::ssize(free_.R) + (free_.transition ? switches : 0);
}

Bank BankCoordinates::decode(const Eigen::VectorXd& at) const {
  Bank bank = origin_;
  const Index p = free_.theta_unit.rows(), thetas = free_.theta_unit.cols();
  const Eigen::Map<const Eigen::MatrixXd> z(at.data(), p, thetas);
  for (Index j = 0; thetas > 0 && j < bank.mode_count(); ++j) {
    const Index of = origin_.motion_of(j);
    const Eigen::VectorXd theta = origin_.theta(j) + free_.theta_unit.col(of).cwiseProduct(z.col(of));
    bank.modes[j].model = unpack(bank.structure, theta);
  }
  const double* next = set_process_noise(at.data() + z.size(), free_, bank);
  for (const Index i : free_.R)
    // A value below the bound is set to the bound. Otherwise it could only fall, and would become negative.
    bank.R(i, i) = free_.least_R(i) + std::max(origin_.R(i, i) - free_.least_R(i), 0.0) * bounded_exp(*next++);
  if (free_.transition && bank.mode_count() > 1) set_transition(next, bank);
  return bank;
}

Eigen::MatrixXd BankCoordinates::jacobian() const {
  Eigen::MatrixXd result(parameters_of(origin_, free_).size(), size());
  for (Index c = 0; c < size(); ++c) {
    const Eigen::VectorXd step = jacobian_step * Eigen::VectorXd::Unit(size(), c);
    result.col(c) = (parameters_of(decode(step), free_) - parameters_of(decode(-step), free_)) / (2.0 * jacobian_step);
  }
  return result;
}

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
  return prior ? modebank::log_prior(*prior, switching_model(bank)) : 0.0;
}

LikelihoodMaximum maximise_likelihood(const LikelihoodTarget& target, const FreeParameters& free, const Bank& start,
                                      const AscentLimits& limits) {
  const double transitions = static_cast<double>(target.recording.transitions(Role::train));
  const double small_gain = std::min(remaining_gain, limits.tolerance * transitions);
  LikelihoodMaximum best{start, target.value(start)};
  if (!std::isfinite(best.value)) return best;
  Eigen::VectorXd steps;
  while (true) {
    const BankCoordinates around(best.bank, free);
    if (steps.size() == 0) steps.setConstant(around.size(), first_step);
    auto nearby = std::make_unique<NearbyTarget>(target, around, best.value, steps);
    const double gain = nearby->set_units();
    if (std::isnan(gain)) return best;
    if (gain <= small_gain)
      best.end = MeasuredFit::converged;
    else if (best.iterations >= limits.max_iterations)
      best.end = MeasuredFit::iteration_limit;
    if (best.end != MeasuredFit::stalled) return best;
    steps = nearby->steps();
    Bank end;
    const auto [made, expected] = bfgs(std::move(nearby), small_gain, limits.max_iterations - best.iterations, end);
    best.iterations += made;
    const double value = target.value(end);
    if (!(value > best.value)) return best;
    // A new metric costs two filter passes per coordinate; a gradient costs three passes in total.
    if (expected <= small_gain) best.end = MeasuredFit::converged;
    best = {std::move(end), value, best.iterations, best.end};
    if (best.end == MeasuredFit::converged) return best;
  }
}

}  // namespace modebank
