#include "app/text/mode_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

/// distance of an eigenvalue from one that still counts as an integrator; it allows for rounding
constexpr double integrator_slack = 1e-12;
/// relative step of a parameter: the cube root of the machine precision, which is best for central differences
constexpr double difference_step = 6e-6;

Decay decay_of(const std::complex<double>& lambda, double dt_s) {
  const double size = std::abs(lambda), log_size = std::log(size);
  Decay decay;
  decay.per_sample = lambda.imag() == 0.0 ? lambda.real() : size;
  decay.time_constant_s = size == 0.0                             ? 0.0
                          : std::abs(log_size) < integrator_slack ? std::numeric_limits<double>::infinity()
                                                                  : -dt_s / log_size;
  decay.frequency_hz = size == 0.0 ? 0.0 : std::abs(std::arg(lambda)) / (2.0 * std::numbers::pi * dt_s);
  return decay;
}

/// Key for sorting decays. A growing mode never dies out, so it comes before slow modes.
double slowness(const Decay& decay) {
  return decay.time_constant_s < 0.0 ? std::numeric_limits<double>::infinity() : decay.time_constant_s;
}

/// NaN if the state never settles at a constant input.
Eigen::MatrixXd steady_gain(const Bank& bank, const LinearModel& model, bool settles) {
  const Eigen::Index inputs = bank.structure.inputs;
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(model.A.rows(), inputs);
  for (Eigen::Index first = 0; first < model.B.cols(); first += inputs) held += model.B.middleCols(first, inputs);
  const PivotedLu lu(-model.A);
  if (!settles || !lu.invertible()) return Eigen::MatrixXd::Constant(bank.C.rows(), inputs, not_a_number);
  return bank.C * lu.solve(held);
}

ModeDynamics dynamics_of(const Bank& bank, const LinearModel& model) {
  ModeDynamics dynamics;
  const Eigen::VectorXcd lambdas = eigenvalues(model.full_form());
  for (const std::complex<double>& lambda : lambdas)
    if (lambda.imag() >= 0.0) dynamics.decays.push_back(decay_of(lambda, bank.dt_s));
  std::stable_sort(dynamics.decays.begin(), dynamics.decays.end(),
                   [](const Decay& a, const Decay& b) { return slowness(a) > slowness(b); });
  const bool settles = lambdas.cwiseAbs().maxCoeff() < 1.0 - integrator_slack;
  dynamics.gain = bank.structure.inputs > 0 ? steady_gain(bank, model, settles) : Eigen::MatrixXd(bank.C.rows(), 0);
  return dynamics;
}

/// All numbers of a mode: time constants, then gains.
Eigen::VectorXd numbers_of(const ModeDynamics& dynamics) {
  const auto decays = static_cast<Eigen::Index>(dynamics.decays.size());
  Eigen::VectorXd numbers(decays + dynamics.gain.size());
  for (Eigen::Index i = 0; i < decays; ++i) numbers(i) = dynamics.decays[static_cast<std::size_t>(i)].time_constant_s;
  numbers.tail(dynamics.gain.size()) = dynamics.gain.reshaped();
  return numbers;
}

/// Covariance of theta; empty if standard errors are unknown.
Eigen::MatrixXd covariance_of(const Mode& mode, Eigen::Index parameters) {
  if (mode.standard_error.size() != parameters) return {};
  Eigen::MatrixXd covariance = mode.standard_error.cwiseAbs2().asDiagonal();
  if (mode.parameter_covariance.rows() != parameters || !(mode.parameter_covariance.diagonal().array() > 0.0).all())
    return covariance;
  const Eigen::VectorXd scale = mode.standard_error.cwiseQuotient(mode.parameter_covariance.diagonal().cwiseSqrt());
  return scale.asDiagonal() * mode.parameter_covariance * scale.asDiagonal();
}

using NumbersOf = std::function<Eigen::VectorXd(const LinearModel&)>;

/// Derivatives of `numbers` with respect to theta. NaN if a step of theta changes the number of values, for example at
/// a double root.
Eigen::MatrixXd derivatives(const Bank& bank, const Eigen::VectorXd& theta, Eigen::Index count,
                            const NumbersOf& numbers) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Constant(count, theta.size(), not_a_number);
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const double step = difference_step * std::max(std::abs(theta(j)), 1e-3);
    Eigen::VectorXd above = theta, below = theta;
    above(j) += step;
    below(j) -= step;
    const Eigen::VectorXd up = numbers(unpack(bank.structure, above)), down = numbers(unpack(bank.structure, below));
    if (up.size() == count && down.size() == count) jacobian.col(j) = (up - down) / (above(j) - below(j));
  }
  return jacobian;
}

/// Standard errors of numbers that are computed from a mode's model, by the delta method. A standard error is NaN if it
/// is unknown, or if a small step of theta changes the number of values.
Eigen::VectorXd errors_of_numbers(const Bank& bank, Eigen::Index mode, const NumbersOf& numbers) {
  const Mode& chosen = bank.modes.at(static_cast<std::size_t>(mode));
  const Eigen::Index count = numbers(chosen.model).size();
  const Eigen::MatrixXd covariance = covariance_of(chosen, bank.structure.parameters());
  if (covariance.size() == 0) return Eigen::VectorXd::Constant(count, not_a_number);
  const Eigen::MatrixXd J = derivatives(bank, bank.theta(mode), count, numbers);
  Eigen::VectorXd errors(count);
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    // A parameter whose error is unknown affects only the numbers that depend on it.
    std::vector<Eigen::Index> moving;
    for (Eigen::Index j = 0; j < J.cols(); ++j)
      if (J(i, j) != 0.0) moving.push_back(j);
    const Eigen::RowVectorXd slope = J(i, moving);
    errors(i) = std::sqrt((slope * covariance(moving, moving) * slope.transpose()).value());
  }
  return errors;
}

}  // namespace

ModeDynamics mode_dynamics(const Bank& bank, Eigen::Index mode) {
  const Mode& chosen = bank.modes.at(static_cast<std::size_t>(mode));
  ModeDynamics dynamics = dynamics_of(bank, chosen.model);
  const Eigen::Index gains = dynamics.gain.size(), decays = static_cast<Eigen::Index>(dynamics.decays.size());
  const Eigen::VectorXd errors =
      errors_of_numbers(bank, mode, [&](const LinearModel& model) { return numbers_of(dynamics_of(bank, model)); });
  for (Eigen::Index i = 0; i < decays; ++i)
    dynamics.decays[static_cast<std::size_t>(i)].time_constant_error_s = errors(i);
  dynamics.gain_error = errors.tail(gains).reshaped(dynamics.gain.rows(), dynamics.gain.cols());
  return dynamics;
}

void add_responses(Bank& bank) {
  const LinearStructure& s = bank.structure;
  if (s.inputs == 0 || !bank.terms.empty()) return;
  for (Eigen::Index k = 0; k < bank.mode_count(); ++k)
    if (Mode& mode = bank.modes[static_cast<std::size_t>(k)]; mode.response.value.gain.size() == 0)
      mode.response = step_response(s, bank.theta(k), covariance_of(mode, s.parameters()),
                                    s.input_delay.by_input(s.inputs), bank.dt_s);
}

}  // namespace modebank
