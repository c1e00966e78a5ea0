#include "filter/refine_noise.hpp"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>
#include <limits>
#include <utility>

#include "filter/training_likelihood.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {
namespace {

constexpr double log_step = 1e-3;         // of central differences; the likelihood is smooth over far more
constexpr double start_share = 0.05;      // of the mean Q, where the search for R starts
constexpr double least_coordinate = -25;  // log share at which R is zero for every purpose

/// Coordinates: log of the factor on Q, then log R_ii relative to the mean Q_ii of the measured states.
class MeasurementNoise final : public ceres::FirstOrderFunction {
 public:
  MeasurementNoise(Bank bank, const Recording& recording, const FilterOptions& filter)
      : bank_(std::move(bank)), recording_(recording), filter_(filter), scale_(bank_.R.rows()) {
    scale_.setZero();
    for (const Mode& mode : bank_.modes) scale_ += mode.weight * mode.Q.diagonal().head(scale_.size());
  }

  int NumParameters() const override { return static_cast<int>(scale_.size()) + 1; }

  bool Evaluate(const double* coordinates, double* cost, double* gradient) const override {
    const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(coordinates, NumParameters());
    *cost = value(at);
    for (int i = 0; gradient && i < NumParameters(); ++i) gradient[i] = slope(at, i);
    return std::isfinite(*cost);
  }

  Bank decode(const Eigen::VectorXd& at) const {
    Bank bank = bank_;
    for (Mode& mode : bank.modes) mode.Q *= std::exp(at(0));
    bank.R = (scale_.array() * at.tail(scale_.size()).array().max(least_coordinate).exp()).matrix().asDiagonal();
    return bank;
  }

  /// Minus the mean log-likelihood per transition.
  double value(const Eigen::VectorXd& at) const { return mean(decode(at)); }
  double value_of_start() const { return mean(bank_); }
  double transitions() const { return static_cast<double>(recording_.transitions(Role::train)); }

  double curvature(Eigen::VectorXd at, Index i) const {
    const double middle = value(at), step = 10.0 * log_step, center = at(i);
    at(i) = center + step;
    const double above = value(at);
    at(i) = center - step;
    return (above - 2.0 * middle + value(at)) / (step * step);
  }

 private:
  double mean(const Bank& bank) const { return -training_log_likelihood(bank, recording_, filter_) / transitions(); }
  double slope(Eigen::VectorXd at, Index i) const {
    const double center = at(i);
    at(i) = center + log_step;
    const double above = value(at);
    at(i) = center - log_step;
    return (above - value(at)) / (2.0 * log_step);
  }

  Bank bank_;
  const Recording& recording_;
  FilterOptions filter_;
  Eigen::VectorXd scale_;  // mean Q of each measured state
};

}  // namespace

void estimate_measurement_noise(const Recording& recording, const FilterOptions& filter, Bank& bank) {
  auto* noise = new MeasurementNoise(bank, recording, filter);  // the problem owns it
  const ceres::GradientProblem problem(noise);
  const Index n_y = bank.R.rows();
  Eigen::VectorXd at = Eigen::VectorXd::Constant(n_y + 1, std::log(start_share));
  at(0) = std::log1p(-2.0 * start_share);
  const double before = noise->value_of_start();
  if (!(noise->value(at) < before)) return;  // the data ask for none
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 30;
  options.function_tolerance = 1e-7;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, at.data(), &summary);
  if (!(noise->value(at) < before - least_likelihood_gain)) return;
  bank = noise->decode(at);
  bank.R_standard_error = Eigen::MatrixXd::Zero(n_y, n_y);
  for (Index i = 0; i < n_y; ++i) {
    const double curvature = noise->curvature(at, i + 1) * noise->transitions();  // of log R
    bank.R_standard_error(i, i) = curvature > 0.0 ? bank.R(i, i) / std::sqrt(curvature) : not_a_number;
  }
}

}  // namespace modebank
