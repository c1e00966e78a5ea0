#include "ident/fit/window_length.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/base/distributions.hpp"
#include "ident/data/window.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {
namespace {

constexpr double significance = 0.99;       // confidence level of each of the two tests
constexpr double most_changed = 1.0 / 6.0;  // largest share of windows with a change for which windows keep their
                                            // length
constexpr Index enough_windows = 1000;

/// Least squares of some transitions: sums of squared residuals per state, and their degrees of freedom.
struct Residuals {
  Eigen::ArrayXd squares;
  double freedom = 0.0;
};

Residuals residuals_of(const Trajectory& run, Index start, Index count, const LinearStructure& one_lag) {
  const Transitions t = finite_rows(stack_transitions(run, start, count, one_lag));
  if (t.count() == 0) return {Eigen::ArrayXd::Zero(one_lag.states), 0.0};
  const Decomposition d = decompose(t.regressors, excitation_tolerance);
  const Eigen::MatrixXd left = t.increments - d.U * (d.U.transpose() * t.increments);
  return {left.colwise().squaredNorm().transpose().array(), static_cast<double>(t.count() - d.rank())};
}

/// Whether the motion of a window's two halves differs in any state. The level is divided by the number of states
/// (Bonferroni).
bool changes(const Trajectory& run, Index start, Index length, const LinearStructure& one_lag) {
  const Index half = length / 2;
  const Residuals first = residuals_of(run, start, half, one_lag);
  const Residuals second = residuals_of(run, start + half, length - half, one_lag);
  const Residuals whole = residuals_of(run, start, length, one_lag);
  const double freedom = first.freedom + second.freedom, added = whole.freedom - freedom;
  if (first.freedom < 1.0 || second.freedom < 1.0) return false;
  const double share = (1.0 - significance) / static_cast<double>(one_lag.states);
  const Eigen::ArrayXd apart = first.squares + second.squares;
  if (added >= 1.0) {
    const double limit = fisher_quantile(1.0 - share, added, freedom);
    if (((whole.squares - apart) * freedom > limit * added * apart).any()) return true;
  }
  const Eigen::ArrayXd a = first.squares / first.freedom, b = second.squares / second.freedom;
  const double above = fisher_quantile(1.0 - 0.5 * share, first.freedom, second.freedom);
  const double below = fisher_quantile(1.0 - 0.5 * share, second.freedom, first.freedom);
  return (a > above * b).any() || (b > below * a).any();
}

/// Share of windows with a change, over a sample of windows that share no transition.
double changed_share(const Recording& recording, const LinearStructure& one_lag, Index length) {
  const WindowPlan plan(recording, length, length, one_lag.first_transition());
  const Index stride = std::max<Index>(1, plan.count() / enough_windows);
  Index windows = 0, changed = 0;
  for (Index i = 0; i < plan.count(); i += stride) {
    const Window window = plan.window(i);
    ++windows;
    if (changes(recording.runs[static_cast<std::size_t>(window.run)], window.start, length, one_lag)) ++changed;
  }
  return windows > 0 ? static_cast<double>(changed) / static_cast<double>(windows) : 1.0;
}

}  // namespace

Index automatic_length(const Recording& recording, const LinearStructure& structure) {
  const auto length_of = [&](double per_regressor) {
    const double wanted = std::ceil(per_regressor * static_cast<double>(structure.regressors()));
    return std::max(shortest_automatic_length, static_cast<Index>(wanted));
  };
  const Index shortest = length_of(1.5);
  for (const double per_regressor : {3.0, 2.0}) {
    const Index length = length_of(per_regressor);
    if (length > shortest && changed_share(recording, structure.with_one_lag(), length) <= most_changed) return length;
  }
  // Runs that are too short for such a window may still hold a window of the smallest length. If they do not, the
  // function that forms windows throws an error.
  return WindowPlan(recording, shortest, 1, structure.first_transition()).count() > 0 ? shortest
                                                                                      : shortest_automatic_length;
}

Index automatic_length(const Recording& recording, const FitOptions& options) {
  return automatic_length(recording, linear_structure(recording.state_count(), recording.input_count(), options));
}

Index automatic_step(const Recording& recording) {
  constexpr Index enough_windows = 100000;
  return std::max<Index>(1, recording.transitions(Role::train) / enough_windows);
}

}  // namespace modebank
