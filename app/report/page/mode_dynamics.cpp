#include "app/report/page/mode_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

/// From here on an eigenvalue's distance to one is rounding: an integrator.
constexpr double integrator_slack = 1e-12;

Decay decay_of(const std::complex<double>& lambda, double dt_s) {
  const double size = std::abs(lambda), log_size = std::log(size);
  Decay decay;
  decay.time_constant_s = size == 0.0                             ? 0.0
                          : std::abs(log_size) < integrator_slack ? std::numeric_limits<double>::infinity()
                                                                  : -dt_s / log_size;
  decay.frequency_hz = size == 0.0 ? 0.0 : std::abs(std::arg(lambda)) / (2.0 * std::numbers::pi * dt_s);
  return decay;
}

/// What grows never dies out: it comes before what dies out slowly.
double slowness(const Decay& decay) {
  return decay.time_constant_s < 0.0 ? std::numeric_limits<double>::infinity() : decay.time_constant_s;
}

Eigen::MatrixXd steady_gain(const Bank& bank, const LinearModel& model) {
  const Eigen::Index inputs = bank.structure.inputs;
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(model.A.rows(), inputs);
  for (Eigen::Index first = 0; first < model.B.cols(); first += inputs) held += model.B.middleCols(first, inputs);
  const PivotedLu lu(-model.A);
  if (!lu.invertible()) return Eigen::MatrixXd::Constant(bank.C.rows(), inputs, not_a_number);
  return bank.C * lu.solve(held);
}

}  // namespace

ModeDynamics mode_dynamics(const Bank& bank, Eigen::Index mode) {
  const LinearModel& model = bank.modes.at(static_cast<std::size_t>(mode)).model;
  ModeDynamics dynamics;
  const Eigen::VectorXcd lambdas = eigenvalues(model.full_form());
  for (const std::complex<double>& lambda : lambdas)
    if (lambda.imag() >= 0.0) dynamics.decays.push_back(decay_of(lambda, bank.dt_s));
  std::stable_sort(dynamics.decays.begin(), dynamics.decays.end(),
                   [](const Decay& a, const Decay& b) { return slowness(a) > slowness(b); });
  dynamics.gain = bank.structure.inputs > 0 ? steady_gain(bank, model) : Eigen::MatrixXd(bank.C.rows(), 0);
  return dynamics;
}

}  // namespace modebank
