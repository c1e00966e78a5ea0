#include "filter/learn/likelihood/coordinates.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

using Eigen::Index;

// Step of central differences for the formulas of the coordinates. The formulas are exponentials; the error is 2e-9.
constexpr double jacobian_step = 1e-4;

// exp of a bounded logarithm; cannot overflow.
double bounded_exp(double z) { return std::exp(std::clamp(z, -30.0, 30.0)); }

}  // namespace

BankCoordinates::BankCoordinates(Bank origin, FreeParameters free)
    : origin_(std::move(origin)), free_(std::move(free)) {}

Index BankCoordinates::size() const {
  const Index K = origin_.mode_count();
  const Index noise = free_.Q_by_one_factor ? 1 : K * places().triangle;
  return free_.theta_unit.size() + noise + std::ssize(free_.R) + (free_.transition ? K * (K - 1) : 0);
}

ParameterPlaces BankCoordinates::places() const {
  const Index n = origin_.structure.states;
  return {free_.theta_unit.rows(), n * (n + 1) / 2, origin_.mode_count(), std::ssize(free_.R), free_.transition};
}

Bank BankCoordinates::decode(const Eigen::VectorXd& at) const {
  Bank bank = origin_;
  const double* next = set_theta(at.data(), bank);
  next = set_process_noise(next, bank);
  next = set_measurement_noise(next, bank);
  if (free_.transition) set_transition(next, bank);
  return bank;
}

const double* BankCoordinates::set_theta(const double* at, Bank& bank) const {
  const Index p = free_.theta_unit.rows(), thetas = free_.theta_unit.cols();
  for (Index j = 0; thetas > 0 && j < bank.mode_count(); ++j) {
    const Index of = thetas == 1 ? 0 : j;
    const Eigen::Map<const Eigen::VectorXd> z(at + of * p, p);
    const Eigen::VectorXd theta = origin_.theta(j) + free_.theta_unit.col(of).cwiseProduct(z);
    bank.modes[static_cast<std::size_t>(j)].model = unpack(bank.structure, theta);
  }
  return at + thetas * p;
}

const double* BankCoordinates::set_process_noise(const double* at, Bank& bank) const {
  const Index n = origin_.structure.states;
  if (free_.Q_by_one_factor) {
    for (Mode& mode : bank.modes) mode.Q *= bounded_exp(*at);
    return at + 1;
  }
  for (Mode& mode : bank.modes) {
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a, ++at) M(a, b) = a == b ? bounded_exp(*at) : *at;
    const Eigen::MatrixXd L0 = Cholesky(mode.Q.topLeftCorner(n, n)).L();
    const Eigen::MatrixXd L = L0 * M;
    mode.Q.topLeftCorner(n, n).noalias() = L * L.transpose();
    if (free_.least_Q.size() > 0) mode.Q.diagonal().head(n) = mode.Q.diagonal().head(n).cwiseMax(free_.least_Q);
  }
  return at;
}

const double* BankCoordinates::set_measurement_noise(const double* at, Bank& bank) const {
  for (const Index i : free_.R)
    // A value below the bound is set to the bound. Otherwise it could only fall, and would become negative.
    bank.R(i, i) = free_.least_R(i) + std::max(origin_.R(i, i) - free_.least_R(i), 0.0) * bounded_exp(*at++);
  return at;
}

void BankCoordinates::set_transition(const double* at, Bank& bank) const {
  const Index K = bank.mode_count();
  if (K == 1) return;
  Eigen::MatrixXd T = origin_.transition.matrix();
  for (Index i = 0; i < K; ++i) {
    Index largest = 0;
    T.row(i).maxCoeff(&largest);
    for (Index j = 0; j < K; ++j)
      if (j != largest) T(i, j) *= bounded_exp(*at++);
    T.row(i) /= T.row(i).sum();
  }
  bank.transition = TransitionMatrix(T);
}

Eigen::VectorXd BankCoordinates::parameters_of(const Bank& bank) const {
  const ParameterPlaces at = places();
  const Index n = bank.structure.states;
  Eigen::VectorXd all(at.size());
  for (Index j = 0; j < at.modes; ++j) {
    if (at.parameters > 0) all.segment(at.theta(j), at.parameters) = bank.theta(j);
    const Eigen::MatrixXd& Q = bank.modes[static_cast<std::size_t>(j)].Q;
    Index next = at.Q(j);
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a) all(next++) = Q(a, b);
    if (at.transition) all.segment(at.T(j), at.modes) = bank.transition.matrix().row(j);
  }
  for (Index i = 0; i < at.outputs; ++i) {
    const Index output = free_.R[static_cast<std::size_t>(i)];
    all(at.R() + i) = bank.R(output, output);
  }
  return all;
}

Eigen::MatrixXd BankCoordinates::jacobian() const {
  Eigen::MatrixXd result(places().size(), size());
  for (Index c = 0; c < size(); ++c) {
    const Eigen::VectorXd step = jacobian_step * Eigen::VectorXd::Unit(size(), c);
    result.col(c) = (parameters_of(decode(step)) - parameters_of(decode(-step))) / (2.0 * jacobian_step);
  }
  return result;
}

}  // namespace modebank
