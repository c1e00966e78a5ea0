#include "filter/bank_coordinates.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace modebank {
namespace {

// Of a logarithm: far enough for every purpose, and nothing overflows.
double bounded_exp(double z) { return std::exp(std::clamp(z, -30.0, 30.0)); }

}  // namespace

BankCoordinates::BankCoordinates(Bank origin, SharedParts shared, Eigen::MatrixXd theta_unit, Eigen::VectorXd R_bound)
    : origin_(std::move(origin)), shared_(shared), theta_unit_(std::move(theta_unit)), R_bound_(std::move(R_bound)) {}

Index BankCoordinates::size() const {
  const Index n = origin_.structure.states, K = origin_.mode_count();
  return thetas() * origin_.structure.parameters() + noises() * n * (n + 1) / 2 + R_bound_.size() + K * (K - 1);
}

Bank BankCoordinates::decode(const Eigen::VectorXd& at) const {
  Bank bank = origin_;
  const double* next = set_theta(at.data(), bank);
  next = set_process_noise(next, bank);
  next = set_measurement_noise(next, bank);
  set_transition(next, bank);
  return bank;
}

const double* BankCoordinates::set_theta(const double* at, Bank& bank) const {
  const Index p = bank.structure.parameters();
  for (Index j = 0; j < bank.mode_count(); ++j) {
    const Index of = thetas() == 1 ? 0 : j;
    const Eigen::Map<const Eigen::VectorXd> z(at + of * p, p);
    const Eigen::VectorXd theta = origin_.theta(j) + theta_unit_.col(of).cwiseProduct(z);
    bank.modes[static_cast<std::size_t>(j)].model = unpack(bank.structure, theta);
  }
  return at + thetas() * p;
}

const double* BankCoordinates::set_process_noise(const double* at, Bank& bank) const {
  const Index n = bank.structure.states, each = n * (n + 1) / 2;
  for (Index j = 0; j < bank.mode_count(); ++j) {
    const double* z = at + (noises() == 1 ? 0 : j) * each;
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a, ++z) M(a, b) = a == b ? bounded_exp(*z) : *z;
    Eigen::MatrixXd& Q = bank.modes[static_cast<std::size_t>(j)].Q;
    const Eigen::MatrixXd L0 = Q.topLeftCorner(n, n).llt().matrixL();
    const Eigen::MatrixXd L = L0 * M;
    Q.topLeftCorner(n, n).noalias() = L * L.transpose();
  }
  return at + noises() * each;
}

const double* BankCoordinates::set_measurement_noise(const double* at, Bank& bank) const {
  for (Index i = 0; i < R_bound_.size(); ++i)
    bank.R(i, i) = R_bound_(i) + (origin_.R(i, i) - R_bound_(i)) * bounded_exp(at[i]);
  return at + R_bound_.size();
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

}  // namespace modebank
