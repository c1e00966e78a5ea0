#include "filter/refine_errors.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "filter/evaluate.hpp"
#include "filter/refine_start.hpp"
#include "ident/not_a_number.hpp"
#include "ident/stretch.hpp"

namespace modebank {
namespace {

constexpr double relative_step = 1e-2;  // of a standard error, a variance or a probability
constexpr double most_numbers = 4e6;    // samples times parameters
constexpr Index fewest_samples = 2000, most_samples = 20000;

/// A direction in which the bank is moved.
struct Coordinate {
  std::function<void(Bank&, double)> move;
  double step = 0.0;
  double prior_information = 0.0;
};

/// Where the coordinates of each part begin.
struct Layout {
  std::vector<Coordinate> coordinates;
  std::vector<Index> theta, Q;  // of each mode; shared parts begin at the same place
  Index R = -1;
  std::vector<Index> row;             // of T
  std::vector<Index> largest_in_row;  // takes what the others give

  Index size() const { return std::ssize(coordinates); }
};

std::vector<Index> modes_of(Index j, bool shared, Index K) {
  if (!shared) return {j};
  std::vector<Index> all(static_cast<std::size_t>(K));
  for (Index i = 0; i < K; ++i) all[static_cast<std::size_t>(i)] = i;
  return all;
}

void add_theta(const Bank& bank, const std::vector<Index>& modes, Layout& layout) {
  const Eigen::VectorXd& error = bank.modes[static_cast<std::size_t>(modes.front())].standard_error;
  for (Index a = 0; a < error.size(); ++a)
    layout.coordinates.push_back({[a, modes](Bank& moved, double by) {
                                    for (const Index j : modes) {
                                      Eigen::VectorXd theta = moved.theta(j);
                                      theta(a) += by;
                                      moved.modes[static_cast<std::size_t>(j)].model = unpack(moved.structure, theta);
                                    }
                                  },
                                  relative_step * error(a)});
}

/// Lower triangle of Q, column by column. The prior is worth `transitions`.
void add_noise(const Bank& bank, const std::vector<Index>& modes, double transitions, Layout& layout) {
  const Eigen::MatrixXd& Q = bank.modes[static_cast<std::size_t>(modes.front())].Q;
  for (Index b = 0; b < bank.structure.states; ++b)
    for (Index a = b; a < bank.structure.states; ++a) {
      const double scale = Q(a, a) * Q(b, b);
      layout.coordinates.push_back({[a, b, modes](Bank& moved, double by) {
                                      for (const Index j : modes) {
                                        Eigen::MatrixXd& noise = moved.modes[static_cast<std::size_t>(j)].Q;
                                        noise(a, b) += by;
                                        if (a != b) noise(b, a) = noise(a, b);
                                      }
                                    },
                                    relative_step * std::sqrt(scale), (a == b ? 0.5 : 1.0) * transitions / scale});
    }
}

void add_transition(const Bank& bank, double counts, Layout& layout) {
  const Eigen::MatrixXd& T = bank.transition.matrix();
  for (Index i = 0; i < T.rows(); ++i) {
    Index largest = 0;
    T.row(i).maxCoeff(&largest);
    layout.row.push_back(layout.size());
    layout.largest_in_row.push_back(largest);
    for (Index j = 0; j < T.cols(); ++j) {
      if (j == largest) continue;
      const double least = std::max(T(i, j), std::numeric_limits<double>::min());
      layout.coordinates.push_back({[i, j, largest](Bank& moved, double by) {
                                      Eigen::MatrixXd matrix = moved.transition.matrix();
                                      matrix(i, j) += by;
                                      matrix(i, largest) -= by;
                                      moved.transition = TransitionMatrix(matrix);
                                    },
                                    relative_step * least, counts / (least * least)});
    }
  }
}

Layout lay_out(const Bank& bank, const SwitchingPrior& prior, SharedParts shared, bool with_R) {
  Layout layout;
  const Index K = bank.mode_count();
  const bool one_theta = shared == SharedParts::theta, one_noise = shared == SharedParts::noise;
  for (Index j = 0; j < K; ++j) {
    layout.theta.push_back(one_theta && j > 0 ? layout.theta.front() : layout.size());
    if (!one_theta || j == 0) add_theta(bank, modes_of(j, one_theta, K), layout);
  }
  for (Index j = 0; j < K; ++j) {
    layout.Q.push_back(one_noise && j > 0 ? layout.Q.front() : layout.size());
    if (!one_noise || j == 0) add_noise(bank, modes_of(j, one_noise, K), prior.noise_transitions, layout);
  }
  if (with_R) layout.R = layout.size();
  for (Index i = 0; with_R && i < bank.R.rows(); ++i)
    layout.coordinates.push_back({[i](Bank& moved, double by) { moved.R(i, i) += by; }, relative_step * bank.R(i, i)});
  if (K > 1) add_transition(bank, prior.counts, layout);
  return layout;
}

/// The first training samples, as many as are wanted, and by what their information is to be multiplied.
struct Share {
  std::vector<Trajectory> runs;
  double factor = 1.0;
};

Share first_samples(const Recording& recording, Index coordinates) {
  Index room =
      std::clamp(static_cast<Index>(most_numbers / static_cast<double>(coordinates)), fewest_samples, most_samples);
  Share share;
  Index taken = 0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train || run.samples() < 2 || room < 2) continue;
    share.runs.push_back(run.samples() <= room ? run : stretch(run, 0, room));
    room -= share.runs.back().samples();
    taken += share.runs.back().transitions();
  }
  if (taken > 0) share.factor = static_cast<double>(recording.transitions(Role::train)) / static_cast<double>(taken);
  return share;
}

/// Derivatives of a run's log predictive densities, one coordinate per column; zero where there is none.
Eigen::MatrixXd scores(const Bank& bank, const Layout& layout, const Trajectory& run) {
  Eigen::MatrixXd result(run.samples(), layout.size());
  tbb::parallel_for(Index{0}, layout.size(), [&](Index c) {
    const Coordinate& coordinate = layout.coordinates[static_cast<std::size_t>(c)];
    Bank above = bank, below = bank;
    coordinate.move(above, coordinate.step);
    coordinate.move(below, -coordinate.step);
    result.col(c) = (log_densities(above, run, {}) - log_densities(below, run, {})) / (2.0 * coordinate.step);
  });
  return result.array().isNaN().select(0.0, result);
}

Eigen::MatrixXd covariance_of(const Recording& recording, const Bank& bank, const Layout& layout,
                              const SwitchingPrior& prior) {
  const Share share = first_samples(recording, layout.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(layout.size(), layout.size());
  for (const Trajectory& run : share.runs) {
    const Eigen::MatrixXd of_run = scores(bank, layout, run);
    information.noalias() += share.factor * of_run.transpose() * of_run;
  }
  const Index p = prior.mean.size();
  for (std::size_t j = 0; j < layout.theta.size(); ++j)
    if (j == 0 || layout.theta[j] != layout.theta.front())
      information.block(layout.theta[j], layout.theta[j], p, p) += prior.information;
  for (Index c = 0; c < layout.size(); ++c)
    information(c, c) += layout.coordinates[static_cast<std::size_t>(c)].prior_information;
  // Parameters differ in scale by orders of magnitude: the factorisation sees correlations.
  const Eigen::VectorXd unit =
      information.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::MatrixXd inverse = scaled.ldlt().solve(Eigen::MatrixXd::Identity(layout.size(), layout.size()));
  return unit.asDiagonal() * inverse * unit.asDiagonal();
}

/// Given the smoothed modes: of theta by its posterior covariance, of Q by the normal scatter's (Q_ii Q_jj + Q_ij^2) /
/// W, of T by the binomial's.
void set_complete_errors(const SwitchingSums& sums, const SwitchingPrior& prior, Bank& bank,
                         const SwitchingRegression& model) {
  const std::vector<Eigen::MatrixXd> covariances = parameter_covariances(sums, prior, model);
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    Mode& mode = bank.modes[j];
    const double weight = std::max(sums.modes[j].transitions, std::numeric_limits<double>::min());
    mode.spread = covariances[j];
    mode.standard_error = mode.spread.diagonal().cwiseSqrt();
    const Eigen::VectorXd variance = mode.Q.diagonal();
    mode.Q_standard_error =
        ((variance * variance.transpose()).array() + mode.Q.array().square()).sqrt() / std::sqrt(weight);
  }
  const Eigen::ArrayXXd T = bank.transition.matrix().array();
  const Eigen::ArrayXd rows = sums.switches.rowwise().sum().array() + 1.0;
  bank.transition_standard_error = ((T * (1.0 - T)).colwise() / rows).sqrt().matrix();
}

void set_observed_errors(const Layout& layout, const Eigen::MatrixXd& covariance, Bank& bank) {
  const Index p = bank.structure.parameters(), n = bank.structure.states, K = bank.mode_count();
  const Eigen::VectorXd error = covariance.diagonal().cwiseSqrt();
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    Mode& mode = bank.modes[j];
    mode.spread = covariance.block(layout.theta[j], layout.theta[j], p, p);
    mode.standard_error = error.segment(layout.theta[j], p);
    Index at = layout.Q[j];
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a, ++at) mode.Q_standard_error(a, b) = mode.Q_standard_error(b, a) = error(at);
  }
  if (layout.R >= 0) bank.R_standard_error = error.segment(layout.R, bank.R.rows()).asDiagonal();
  for (std::size_t i = 0; i < layout.row.size(); ++i) {
    const auto row = static_cast<Index>(i);
    Index at = layout.row[i];
    for (Index j = 0; j < K; ++j)
      if (j != layout.largest_in_row[i]) bank.transition_standard_error(row, j) = error(at++);
    bank.transition_standard_error(row, layout.largest_in_row[i]) =
        std::sqrt(covariance.block(layout.row[i], layout.row[i], K - 1, K - 1).sum());
  }
}

}  // namespace

void set_weights(const Eigen::VectorXd& transitions, Bank& bank) {
  const Eigen::VectorXd weights = transitions.cwiseMax(std::numeric_limits<double>::min());
  for (Index j = 0; j < weights.size(); ++j)
    bank.modes[static_cast<std::size_t>(j)].weight = weights(j) / weights.sum();
}

void set_standard_errors(const Recording& recording, const SwitchingSums& complete, const SwitchingPrior& prior,
                         SharedParts shared, bool with_R, Bank& bank) {
  set_complete_errors(complete, prior, bank, switching_model(bank));
  const Layout layout = lay_out(bank, prior, shared, with_R);
  const Eigen::MatrixXd covariance = covariance_of(recording, bank, layout, prior);
  if (covariance.allFinite() && covariance.diagonal().minCoeff() > 0.0) set_observed_errors(layout, covariance, bank);
}

}  // namespace modebank
