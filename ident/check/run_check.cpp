#include "ident/check/run_check.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/lag/objective.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double settle_s = 0.5;
constexpr double least_rest_s = 1.0;

bool is_still(const VectorXd& input, const VectorXd& level) {
  return (input.cwiseAbs().array() <= level.array()).all();
}

}  // namespace

std::vector<bool> still_samples(const Stream& inputs, const VectorXd& still_level) {
  std::vector<bool> still(static_cast<std::size_t>(inputs.values.cols()), false);
  if (still_level.size() == 0) return still;
  for (Index k = 1; k < inputs.values.cols(); ++k)
    still[static_cast<std::size_t>(k)] =
        is_still(inputs.values.col(k), still_level) && is_still(inputs.values.col(k - 1), still_level);
  return still;
}

std::vector<bool> resting_samples(const Stream& states, const Stream& inputs, const VectorXd& still_level) {
  const Index N = states.values.cols();
  if (still_level.size() == 0 || inputs.time_s.size() == 0 || N == 0)
    return std::vector<bool>(static_cast<std::size_t>(N), false);
  std::vector<bool> rests = still_samples({states.time_s, hold(inputs, states.time_s)}, still_level);
  for (Index k = 1; k < N; ++k)
    if (states.values.col(k) != states.values.col(k - 1)) rests[static_cast<std::size_t>(k)] = false;
  return rests;
}

double repeats_in_motion(const VectorXd& values, const std::vector<bool>& at_rest) {
  double repeats = 0.0, known = 0.0;
  for (Index k = 1; k < values.size(); ++k) {
    if (at_rest[static_cast<std::size_t>(k)] || !std::isfinite(values(k)) || !std::isfinite(values(k - 1))) continue;
    known += 1.0;
    repeats += values(k) == values(k - 1) ? 1.0 : 0.0;
  }
  return known > 0.0 ? repeats / known : 0.0;
}

CommandCheck check_commands(const Stream& inputs, const VectorXd& still_level) {
  CommandCheck check;
  const Index N = inputs.time_s.size();
  if (N == 0) return check;
  Index still = 0, changes = 0, since = 0;
  for (Index k = 0; k < N; ++k) {
    const bool rests = is_still(inputs.values.col(k), still_level);
    still += rests ? 1 : 0;
    const bool changed = k > 0 && inputs.values.col(k) != inputs.values.col(k - 1);
    changes += changed ? 1 : 0;
    if (changed) since = k;
    if (!rests) check.longest_constant_s = std::max(check.longest_constant_s, inputs.time_s(k) - inputs.time_s(since));
  }
  check.still = static_cast<double>(still) / static_cast<double>(N);
  check.changes = N > 1 ? static_cast<double>(changes) / static_cast<double>(N - 1) : 0.0;
  return check;
}

RestCheck check_rest(const Stream& states, const Stream& inputs, const VectorXd& still_level) {
  const Index n = states.values.rows(), N = inputs.time_s.size();
  RestCheck check{0.0, VectorXd::Constant(n, not_a_number), VectorXd::Constant(n, not_a_number)};
  std::vector<Index> rest;
  for (Index k = 0; k < N; ++k) {
    if (!is_still(inputs.values.col(k), still_level)) continue;
    Index end = k;
    while (end + 1 < N && is_still(inputs.values.col(end + 1), still_level)) ++end;
    const double from_s = inputs.time_s(k) + settle_s, to_s = inputs.time_s(end);
    if (to_s - inputs.time_s(k) >= least_rest_s) {
      check.duration_s += to_s - from_s;
      const double* const begin = states.time_s.data();
      const double* const last = begin + states.time_s.size();
      for (const double* t = std::lower_bound(begin, last, from_s); t != last && *t <= to_s; ++t)
        if (states.values.col(t - begin).allFinite()) rest.push_back(t - begin);
    }
    k = end;
  }
  if (rest.size() < 2) return check;
  const MatrixXd values = states.values(Eigen::all, rest);
  check.mean = values.rowwise().mean();
  check.sd = (values.colwise() - check.mean).array().square().rowwise().mean().sqrt();
  return check;
}

Index excitation_order(const MatrixXd& inputs, Index most) {
  constexpr double least_eigenvalue = 1e-4;
  const Index m = inputs.rows(), N = inputs.cols();
  if (m == 0) return 0;
  const VectorXd rms = (inputs.array().square().rowwise().mean()).sqrt();
  if (!(rms.minCoeff() > 0.0) || !inputs.allFinite()) return 0;
  const MatrixXd scaled = rms.cwiseInverse().asDiagonal() * inputs;
  Index order = 0;
  for (Index d = 1; d <= most && N > 2 * d * m; ++d) {
    MatrixXd delayed(d * m, N - d + 1);
    for (Index i = 0; i < d; ++i) delayed.middleRows(i * m, m) = scaled.middleCols(i, N - d + 1);
    const MatrixXd moment = delayed * delayed.transpose() / static_cast<double>(N - d + 1);
    if (symmetric_eigenvalues(moment)(0) < least_eigenvalue) break;
    order = d;
  }
  return order;
}

double DeficientWindows::share() const {
  return windows > 0 ? static_cast<double>(deficient) / static_cast<double>(windows) : not_a_number;
}

DeficientWindows count_deficient_windows(const Trajectory& run, Index length, const LinearStructure& structure,
                                         Index most_windows) {
  DeficientWindows count;
  const Index positions = run.transitions() - length + 1;
  const Index stride = std::max<Index>(1, positions / most_windows);
  for (Index start = 0; start < positions; start += stride) {
    const Transitions transitions = finite_rows(stack_transitions(run, start, length, structure));
    ++count.windows;
    if (transitions.count() == 0 ||
        decompose(transitions.regressors, excitation_tolerance).rank() < structure.regressors())
      ++count.deficient;
  }
  return count;
}

}  // namespace modebank
