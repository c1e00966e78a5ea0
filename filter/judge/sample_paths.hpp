#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/imm_filter.hpp"

namespace modebank {

/// Forecast of a bank by random futures from a filter's estimate. Each path draws its state and mode from this
/// estimate, then mode and noise in every step. One generator serves all paths in order, so equal seeds give equal
/// paths. Bands are quantiles of the paths with measurement noise. The joint density has one Gaussian per mode, with
/// the moments of the mode's paths. The noise of the last step is not sampled there; its known covariance is added.
class SamplePaths final : public Forecast {
 public:
  SamplePaths(const Bank& bank, Eigen::Index paths, std::uint64_t seed);

  void start(const FilterState<Eigen::Dynamic>& origin);
  void start(const ImmFilter<Eigen::Dynamic, Eigen::Dynamic>& origin) { start(origin.state()); }
  /// Advances every path by one model step. Removes a path if its values exceed largest_mean.
  void step(const Vector& inputs) override;
  void arrive(Eigen::Index) override;

  double mean(Eigen::Index i) const override;
  double standard_deviation(Eigen::Index i) const override;
  double probability(Eigen::Index i, double y) const override;
  double quantile(Eigen::Index i, double p) const override;
  double observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) override;
  Eigen::VectorXd mode_probability() const override { return share_; }
  Eigen::Index lost_paths() const override { return lost_; }

  Eigen::Index count() const { return states_.cols(); }              ///< remaining paths
  const Eigen::MatrixXd& states() const { return states_; }          ///< n x count
  const std::vector<Eigen::Index>& modes() const { return modes_; }  ///< count, mode of each path in the last step
  /// Q of a mode in the last step: the mean over the paths `in_mode`.
  Eigen::MatrixXd step_noise(Eigen::Index mode, const std::vector<Eigen::Index>& in_mode) const;

 private:
  Bank bank_;
  Eigen::MatrixXd R_, R_root_;
  Eigen::Index paths_, lost_ = 0;
  std::mt19937_64 generator_;
  std::vector<Eigen::MatrixXd> noise_root_;  ///< K
  Eigen::MatrixXd states_, predicted_;       ///< n x count; `predicted_` lacks the last step's noise
  Eigen::MatrixXd sorted_;                   ///< count x n_y, measurements of the present sample
  Eigen::VectorXd noise_factor_;             ///< noise factor of every path in the last step
  std::vector<Eigen::Index> modes_;
  Eigen::VectorXd share_, regressor_, next_, normal_;
  TransitionWorkspace transition_;
  TermValues terms_;

  template <class Probability>
  Eigen::Index draw_mode(const Probability& probability);
  Eigen::Index draw_next_mode(Eigen::Index mode, const Vector& state, const Vector& inputs);
  void add_draw(const Eigen::MatrixXd& root, Eigen::Ref<Eigen::VectorXd> to, double scale = 1.0);
  void add_terms(Eigen::Index mode, const Vector& state, const Vector& inputs);
  double log_density_of_mode(Eigen::VectorXd error, const Eigen::MatrixXd& S) const;
};

}  // namespace modebank
