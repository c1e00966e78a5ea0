#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/imm.hpp"
#include "filter/step/noise_density.hpp"
#include "ident/base/covariance.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

/// Distribution of one signal by M sorted draws: the i-th is the quantile at i / (M + 1), with linear interpolation.
struct DrawnSignal {
  using Index = Eigen::Index;
  Eigen::Ref<const Eigen::VectorXd> sorted;  ///< M
  double mean, deviation;

  double centre() const { return mean; }
  double standard_deviation() const { return deviation; }
  double probability(double y) const {
    const Index M = sorted.size(), below = std::lower_bound(sorted.begin(), sorted.end(), y) - sorted.begin();
    double rank = static_cast<double>(below);
    if (below == 0 || below == M)
      rank += 0.5;
    else if (const double gap = sorted(below) - sorted(below - 1); gap > 0.0)
      rank += (y - sorted(below - 1)) / gap;
    return rank / static_cast<double>(M + 1);
  }
  /// Needs a draw.
  double quantile(double probability_below) const {
    const auto M = static_cast<double>(sorted.size());
    const double place = std::clamp(probability_below * (M + 1.0) - 1.0, 0.0, M - 1.0);
    const auto below = static_cast<Index>(place);
    const Index above = std::min(below + 1, sorted.size() - 1);
    return sorted(below) + (place - static_cast<double>(below)) * (sorted(above) - sorted(below));
  }
};

/// Forecast of a bank by random futures: each path draws its state and mode from a filter's estimate, then mode and
/// noise in every step; one generator serves all paths in order. Bands are quantiles of the paths with measurement
/// noise. The joint density has one Gaussian per mode, with the moments of the mode's paths; the last step's noise is
/// not sampled there, its known covariance is added.
class SamplePaths {
 public:
  using Index = Eigen::Index;
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  SamplePaths(const Bank& bank, Index paths, std::uint64_t seed)
      : bank_(bank),
        R_(bank.recording_noise()),
        R_root_(covariance_root(R_)),
        paths_(paths),
        generator_(seed),
        share_(bank.mode_count()),
        regressor_(bank.structure.regressors()),
        transition_(bank.mode_count(), bank.transition_logit) {
    if (paths < 2) throw std::invalid_argument("at least two sample paths, not " + std::to_string(paths));
    for (const Mode& mode : bank_.modes) noise_root_.push_back(covariance_root(mode.Q));
  }

  void start(const ImmFilter<Eigen::Dynamic, Eigen::Dynamic>& origin) {
    const FilterState<Eigen::Dynamic>& state = origin.state();
    std::vector<Eigen::MatrixXd> start_root;
    for (const Gaussian<Eigen::Dynamic>& mode : state.modes) start_root.push_back(covariance_root(mode.covariance));
    states_.resize(bank_.structure.dimension(), paths_);
    modes_.resize(paths_);
    for (Index i = 0; i < paths_; ++i) {
      modes_[i] = draw_mode(state.mode_probability);
      states_.col(i) = state.modes[modes_[i]].mean;
      add_draw(start_root[modes_[i]], states_.col(i));
    }
    predicted_ = states_;
  }

  /// Advances every path by one model step. Removes a path if its values exceed largest_mean.
  void step(const Vector& inputs) {
    std::vector<Index> finite;
    for (Index i = 0; i < count(); ++i) {
      step_path(i, inputs);
      if ((states_.col(i).array().abs() < largest_mean).all()) finite.push_back(i);
    }
    if (std::ssize(finite) == count()) return;
    for (std::size_t i = 0; i < finite.size(); ++i) modes_[i] = modes_[finite[i]];
    modes_.resize(finite.size());
    states_ = states_(Eigen::all, finite).eval();
    predicted_ = predicted_(Eigen::all, finite).eval();
  }

  /// Draws the measurements of a sample.
  void arrive(Index /*samples*/) {
    Eigen::MatrixXd measured = bank_.C * states_;
    for (Index i = 0; i < measured.cols(); ++i) add_draw(R_root_, measured.col(i));
    sorted_ = measured.transpose();
    for (Index s = 0; s < sorted_.cols(); ++s) std::sort(sorted_.col(s).begin(), sorted_.col(s).end());
    share_.setZero();
    for (const Index mode : modes_) share_(mode) += 1.0 / static_cast<double>(count());
  }

  DrawnSignal signal(Index i) const {
    if (count() == 0) return {sorted_.col(i), not_a_number, not_a_number};
    const Eigen::ArrayXd y = (bank_.C.row(i) * states_).transpose();
    const double variance = (y - y.mean()).square().sum() / static_cast<double>(count() - 1);  // NaN of a single path
    return {sorted_.col(i), bank_.C.row(i).dot(predicted_.rowwise().mean()), std::sqrt(variance + R_(i, i))};
  }

  /// Joint log density of a complete measurement [nats], with a path left. `error`: measurement minus mean, n_y.
  double observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) const {
    const Eigen::MatrixXd predicted = bank_.C * predicted_;
    error = y - predicted.rowwise().mean();
    Eigen::VectorXd log_likelihood = Eigen::VectorXd::Constant(share_.size(), lowest_log_density), posterior = share_;
    small::Ldl<Eigen::Dynamic> factor(y.size());
    for (Index j = 0; j < share_.size(); ++j) {
      std::vector<Index> in_mode;
      for (Index i = 0; i < count(); ++i)
        if (modes_[i] == j) in_mode.push_back(i);
      if (in_mode.empty()) continue;
      Eigen::MatrixXd centred = predicted(Eigen::all, in_mode);
      const Eigen::VectorXd mean = centred.rowwise().mean();
      centred.colwise() -= mean;
      Eigen::VectorXd residual = y - mean;
      factor.factorise(centred * centred.transpose() / static_cast<double>(in_mode.size()) +
                       bank_.C * bank_.modes[j].Q * bank_.C.transpose() + R_);
      factor.decorrelate(residual);
      log_likelihood(j) = 0.0;
      for (Index i = 0; i < y.size(); ++i)
        log_likelihood(j) +=
            ModeSignal{residual(i), factor.D(i)}.log_density(bank_.is_quantised() ? bank_.quantum(i) : 0.0);
    }
    return bayes(share_, log_likelihood, posterior);
  }

  const Eigen::VectorXd& predicted_probability() const { return share_; }  ///< K
  Index lost() const { return paths_ - count(); }                          ///< paths that diverged and were removed

 private:
  Bank bank_;
  Eigen::MatrixXd R_, R_root_;
  Index paths_;
  std::mt19937_64 generator_;
  std::vector<Eigen::MatrixXd> noise_root_;  ///< K
  Eigen::MatrixXd states_, predicted_;       ///< n x count; `predicted_` lacks the last step's noise
  Eigen::MatrixXd sorted_;                   ///< count x n_y, measurements of the present sample
  std::vector<Index> modes_;                 ///< mode of every path in the last step
  Eigen::VectorXd share_, regressor_, normal_;
  TransitionWorkspace transition_;
  TermValues terms_;

  Index count() const { return states_.cols(); }  ///< remaining paths

  /// Adds a draw from N(0, root root').
  void add_draw(const Eigen::MatrixXd& root, Eigen::Ref<Eigen::VectorXd> to) {
    boost::random::normal_distribution<double> standard;
    normal_.resize(root.cols());
    for (double& value : normal_) value = standard(generator_);
    to.noalias() += root * normal_;
  }

  Index draw_mode(const Vector& probability) {
    double u = boost::random::uniform_01<double>()(generator_) * probability.sum();
    Index mode = 0;
    while (mode + 1 < probability.size() && (u -= probability(mode)) >= 0.0) ++mode;
    while (mode > 0 && !(probability(mode) > 0.0)) --mode;  // reached only by rounding
    return mode;
  }

  /// Transition probabilities are those of the path's own state.
  void step_path(Index path, const Vector& inputs) {
    const Eigen::VectorXd state = states_.col(path);
    Index& drawn = modes_[path];
    const Eigen::MatrixXd& T =
        transition_at(bank_.transition.matrix(), bank_.transition_logit, state, inputs, transition_);
    drawn = draw_mode(T.row(drawn).transpose());
    const Mode& mode = bank_.modes[drawn];
    auto next = predicted_.col(path);
    propagate(mode.model.A, mode.model.B, mode.model.c, state, inputs, next);
    if (!bank_.terms.empty()) {
      fill_regressor(bank_.structure, state, inputs, regressor_);
      terms_.evaluate(bank_.terms, regressor_);
      next.head(bank_.structure.states) += mode.bend * terms_.value();
    }
    states_.col(path) = next;
    add_draw(noise_root_[drawn], states_.col(path));
  }
};

}  // namespace modebank
