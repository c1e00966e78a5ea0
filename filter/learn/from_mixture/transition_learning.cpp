#include "filter/learn/from_mixture/transition_learning.hpp"

#include <algorithm>
#include <cmath>

namespace modebank {
namespace {

/// Maps mixture labels to positions in the bank; -1 if the component is not a mode.
std::vector<Index> positions(const Eigen::VectorXi& labels, const std::vector<Index>& kept) {
  Index components = labels.size() > 0 ? labels.maxCoeff() + 1 : 0;
  for (const Index component : kept) components = std::max(components, component + 1);
  std::vector<Index> position(components, -1);
  for (Index j = 0; j < std::ssize(kept); ++j) position[kept[j]] = j;
  return position;
}

}  // namespace

Eigen::MatrixXd count_label_transitions(const WindowFits& fits, const Eigen::VectorXi& labels,
                                        const std::vector<Index>& kept) {
  const std::vector<Index> position = positions(labels, kept);
  const auto mode_of = [&](Index window) { return labels(window) < 0 ? Index{-1} : position[labels(window)]; };
  Eigen::MatrixXd counts = Eigen::MatrixXd::Zero(std::ssize(kept), std::ssize(kept));
  Index from = -1;
  for (Index i = 0; i < fits.count(); ++i) {
    const bool follows = i > 0 && fits.windows[i - 1].run == fits.windows[i].run &&
                         fits.windows[i].start - fits.windows[i - 1].start == fits.step;
    if (!follows) from = -1;
    const Index to = mode_of(i);
    if (from >= 0) counts(from, to >= 0 ? to : from) += 1.0;
    if (to >= 0) from = to;
  }
  return counts;
}

TransitionMatrix transition_from_counts(const Eigen::MatrixXd& counts, Index step) {
  Eigen::MatrixXd T = counts.array() + label_count_smoothing;
  for (Index i = 0; i < T.rows(); ++i) {
    T.row(i) /= T.row(i).sum();
    const double leave = 1.0 - T(i, i);
    if (step == 1 || T.rows() == 1) continue;
    const double stay = std::pow(T(i, i), 1.0 / static_cast<double>(step));
    T.row(i) *= (1.0 - stay) / leave;
    T(i, i) = stay;
  }
  return TransitionMatrix(T);
}

}  // namespace modebank
