#include "filter/united_bank.hpp"

#include <Eigen/LU>
#include <stdexcept>

namespace modebank {
namespace {

using Eigen::Index;

/// pi' = pi' T, sum 1. Where several are, as for modes that never switch, that of a few switches to any mode.
Eigen::VectorXd long_run_share(const Eigen::MatrixXd& T) {
  constexpr double ergodic = 1e-9;
  const Index K = T.rows();
  Eigen::MatrixXd equations = ((1.0 - ergodic) * T.transpose()).array() + ergodic / static_cast<double>(K);
  equations.diagonal().array() -= 1.0;
  equations.row(K - 1).setOnes();
  const Eigen::VectorXd share = equations.partialPivLu().solve(Eigen::VectorXd::Unit(K, K - 1)).cwiseMax(0.0);
  return share / share.sum();
}

/// The members' modes, one after the other.
void append_modes(const Bank& member, double share, Bank& bank) {
  for (Mode mode : member.modes) {
    mode.weight *= share;
    bank.modes.push_back(std::move(mode));
  }
}

}  // namespace

Bank unite(const std::vector<Bank>& members, double switching) {
  if (members.empty()) throw std::invalid_argument("no bank to unite");
  const double share = 1.0 / static_cast<double>(members.size());
  Bank bank = members.front();
  bank.modes.clear();
  for (const Bank& member : members) append_modes(member, share, bank);
  const Index K = bank.mode_count();
  Eigen::MatrixXd within = Eigen::MatrixXd::Zero(K, K), errors = within;
  Eigen::VectorXd entry(K);
  bool have_errors = true;
  bank.initial_probability.resize(K);
  Index at = 0;
  for (const Bank& member : members) {
    const Index k = member.mode_count();
    within.block(at, at, k, k) = member.transition.matrix();
    entry.segment(at, k) = share * long_run_share(member.transition.matrix());
    bank.initial_probability.segment(at, k) = share * member.initial_probability;
    have_errors = have_errors && member.transition_standard_error.rows() == k;
    if (have_errors) errors.block(at, at, k, k) = (1.0 - switching) * member.transition_standard_error;
    at += k;
  }
  bank.transition = TransitionMatrix(((1.0 - switching) * within).rowwise() + switching * entry.transpose());
  if (have_errors) bank.transition_standard_error = errors;
  return bank;
}

}  // namespace modebank
