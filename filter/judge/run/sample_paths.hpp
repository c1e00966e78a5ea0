#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/bank_filter.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// Fills `row` (K) with the probabilities of the next mode, given the last mode, the state (z with lags) before the
/// step and the acting inputs.
using TransitionRow = std::function<void(Eigen::Index mode, const Eigen::Ref<const Eigen::VectorXd>& state,
                                         const Eigen::Ref<const Eigen::VectorXd>& inputs, Eigen::VectorXd& row)>;

/// Random futures of a switching system from a filter's estimate at one moment. Each path draws its state and mode from
/// this estimate, then mode and noise in every step. One generator serves all paths in order, so equal seeds give equal
/// paths.
class SamplePaths {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  /// `row`: computes transition probabilities that are not constant; if empty, the bank's transition matrix is used.
  SamplePaths(const Bank& bank, Eigen::Index paths, std::uint64_t seed, TransitionRow row = {});

  void start(const FilterMemory& origin);
  /// Advances every path by one model step. Removes a path if its values exceed largest_mean.
  void step(const Vector& inputs);

  Eigen::Index lost() const { return lost_; }
  Eigen::Index count() const { return states_.cols(); }              ///< remaining paths
  const Eigen::MatrixXd& states() const { return states_; }          ///< n x count
  const Eigen::MatrixXd& predicted() const { return predicted_; }    ///< n x count, without the last step's noise
  const std::vector<Eigen::Index>& modes() const { return modes_; }  ///< count, mode of each path in the last step

  /// Q of a mode in the last step: the mean over the paths `in_mode`.
  Eigen::MatrixXd step_noise(Eigen::Index mode, const std::vector<Eigen::Index>& in_mode) const;
  /// Adds a draw from N(0, scale^2 root root').
  void add_draw(const Eigen::MatrixXd& root, Eigen::Ref<Eigen::VectorXd> to, double scale = 1.0);

 private:
  Bank bank_;
  Eigen::Index paths_, lost_ = 0;
  TransitionRow row_;
  std::mt19937_64 generator_;
  std::vector<Eigen::MatrixXd> noise_, noise_root_;  ///< K, noise in the scale of the origin
  Eigen::MatrixXd states_, predicted_;
  Eigen::VectorXd noise_factor_;  ///< noise factor of every path in the last step
  std::vector<Eigen::Index> modes_;
  Eigen::VectorXd probability_, regressor_, next_, normal_;
  TermValues terms_;

  Eigen::Index draw_mode(const Eigen::VectorXd& probability);
  void add_terms(Eigen::Index mode, const Vector& state, const Vector& inputs);
  void keep(const std::vector<Eigen::Index>& which);
};

}  // namespace modebank
