#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "filter/learn/competitors/drifting.hpp"
#include "filter/step/noise_density.hpp"

namespace modebank {

/// Sums of logarithms, one per lane. The values are multiplied in groups of eight before the logarithm is taken. Such a
/// product cannot overflow or underflow.
class LogSum {
 public:
  static constexpr Eigen::Index block = 8;

  explicit LogSum(Eigen::Index lanes) : sum_(Eigen::ArrayXd::Zero(lanes)), product_(lanes) {}

  /// Adds the first `count` columns of positive values (lanes x block).
  void add(const Eigen::ArrayXXd& values, Eigen::Index count) {
    product_ = values.col(0);
    for (Eigen::Index j = 1; j < count; ++j) product_ *= values.col(j);
    if (product_.minCoeff() > smallest && product_.maxCoeff() < largest)
      sum_ += product_.log();
    else
      for (Eigen::Index j = 0; j < count; ++j) sum_ += values.col(j).log();
  }
  const Eigen::ArrayXd& sum() const { return sum_; }

 private:
  static constexpr double smallest = 1e-290, largest = 1e290;
  Eigen::ArrayXd sum_, product_;
};

/// Running variances of all (lam, floor) of a grid, one per lane (floor runs fastest), and the sums of densities for
/// all nu. All values are in units of v0.
class DriftingLanes {
 public:
  explicit DriftingLanes(const DriftingGrid& grid)
      : floors_(std::ssize(grid.floor)),
        floor_(std::ssize(grid.lam) * floors_),
        keep_(floor_.size()),
        v_(floor_.size()),
        squares_(Eigen::ArrayXd::Zero(floor_.size())),
        variance_(floor_.size(), LogSum::block),
        square_(floor_.size(), LogSum::block),
        tail_(floor_.size(), LogSum::block),
        log_variance_(floor_.size()),
        log_tail_(grid.nu.size(), LogSum(floor_.size())) {
    for (Eigen::Index lane = 0; lane < floor_.size(); ++lane) {
      floor_(lane) = grid.floor[static_cast<std::size_t>(lane % floors_)];
      keep_(lane) = grid.lam[static_cast<std::size_t>(lane / floors_)];
    }
    for (const double nu : grid.nu) noise_.emplace_back(nu);
  }

  /// Processes e^2 / (1 + h'Ph) of one signal from a start on.
  void follow(const double* ratio, std::size_t count) {
    v_.setOnes();
    for (std::size_t k = 0; k < count; k += LogSum::block)
      take(ratio + k, static_cast<Eigen::Index>(std::min<std::size_t>(LogSum::block, count - k)));
    signals_ += static_cast<double>(count);
  }

  /// Writes the sums of log densities in the grid's order (lam, nu, floor). The sums do not include half of log v0 and
  /// half of log (1 + h'Ph).
  void write(Eigen::Ref<Eigen::VectorXd> out) const {
    const Eigen::Index nus = std::ssize(noise_);
    for (Eigen::Index d = 0; d < nus; ++d) {
      const Eigen::ArrayXd sum = log_densities(static_cast<std::size_t>(d));
      for (Eigen::Index lane = 0; lane < sum.size(); ++lane)
        out((lane / floors_ * nus + d) * floors_ + lane % floors_) = sum(lane);
    }
  }

 private:
  Eigen::Index floors_;
  Eigen::ArrayXd floor_, keep_, v_, squares_;
  Eigen::ArrayXXd variance_, square_, tail_;  ///< lanes x block
  LogSum log_variance_;
  std::vector<LogSum> log_tail_;  ///< per nu: sums of the logarithm of 1 + z^2 / (nu - 2)
  std::vector<StudentNoise> noise_;
  double signals_ = 0.0;

  void take(const double* ratio, Eigen::Index count) {
    for (Eigen::Index j = 0; j < count; ++j) {
      variance_.col(j) = v_;
      square_.col(j) = ratio[j] / v_;
      v_ = (keep_ * v_ + (1.0 - keep_) * ratio[j]).max(floor_);
    }
    log_variance_.add(variance_, count);
    for (std::size_t d = 0; d < noise_.size(); ++d) {
      if (noise_[d].gaussian()) {
        for (Eigen::Index j = 0; j < count; ++j) squares_ += square_.col(j);
        continue;
      }
      tail_.leftCols(count) = 1.0 + square_.leftCols(count) / (noise_[d].degrees() - 2.0);
      log_tail_[d].add(tail_, count);
    }
  }

  Eigen::ArrayXd log_densities(std::size_t d) const {
    const Eigen::ArrayXd sum = signals_ * noise_[d].log_constant() - 0.5 * log_variance_.sum();
    return noise_[d].gaussian() ? Eigen::ArrayXd(sum - 0.5 * squares_)
                                : Eigen::ArrayXd(sum - 0.5 * (noise_[d].degrees() + 1.0) * log_tail_[d].sum());
  }
};

}  // namespace modebank
