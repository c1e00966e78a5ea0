#pragma once

#include <Eigen/Core>

#include "filter/step/equations/bounds.hpp"

namespace modebank {

/// Replaces signal i of a covariance by a signal of variance one without correlation.
template <class Matrix>
void detach(Matrix& S, Eigen::Index i) {
  S.row(i).setZero();
  S.col(i).setZero();
  S(i, i) = 1.0;
}

/// A sensor with missing signals. The rows of C and R for a missing signal become those of a signal that is always
/// zero, has variance one and no correlation, and is measured as zero. Gains, NIS and the other signals' densities are
/// then exactly those of the available signals. For each missing signal, the log density is too small by log(2 pi) / 2.
template <int N, int NY>
struct PartialSensor {
  Eigen::Matrix<double, NY, N> C;
  Eigen::Matrix<double, NY, NY> R;
  Eigen::Matrix<double, NY, 1> y;
  static constexpr bool exact = false;
  Eigen::Index seen_columns;  ///< leading columns of C that contain all nonzero entries (FilterModel)
  Eigen::Index missing = 0;   ///< number of missing signals

  PartialSensor(Eigen::Index n, Eigen::Index n_y) : C(n_y, n), R(n_y, n_y), y(n_y), seen_columns(n) {}

  template <class Sensor, class Y>
  void assign(const Sensor& whole, const Y& measured) {
    C = whole.C;
    R = whole.R;
    y = measured;
    seen_columns = whole.seen_columns;
    missing = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(measured(i))) {
        C.row(i).setZero();
        detach(R, i);
        y(i) = 0.0;
        ++missing;
      }
  }
};

}  // namespace modebank
