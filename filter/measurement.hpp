#pragma once

#include <Eigen/Core>
#include <cmath>

#include "filter/bounds.hpp"

namespace modebank {

inline bool is_missing(double y) { return !(std::abs(y) < largest_measurement); }

/// How many entries of a measurement are missing.
template <class Y>
Eigen::Index missing_entries(const Y& y) {
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < y.size(); ++i) count += is_missing(y(i)) ? 1 : 0;
  return count;
}

/// A sensor some of whose signals are missing: their rows of C and R become those of a signal that is always zero, of
/// variance one, unrelated to anything, and is measured as zero. Gains, NIS and the other signals' densities are then
/// exactly those of the signals that are there; log densities carry -log(2 pi) / 2 too much per missing signal.
template <int N, int NY>
struct PartialSensor {
  Eigen::Matrix<double, NY, N> C;
  Eigen::Matrix<double, NY, NY> R;
  Eigen::Matrix<double, NY, 1> y;
  Eigen::Index missing = 0;  ///< signals

  PartialSensor(Eigen::Index n, Eigen::Index n_y) : C(n_y, n), R(n_y, n_y), y(n_y) {}

  template <class Sensor, class Y>
  void assign(const Sensor& whole, const Y& measured) {
    C = whole.C;
    R = whole.R;
    y = measured;
    missing = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(measured(i))) {
        C.row(i).setZero();
        detach(R, i);
        y(i) = 0.0;
        ++missing;
      }
  }

  /// Makes signal i of a covariance one of variance one, unrelated to the others.
  template <class Matrix>
  static void detach(Matrix& S, Eigen::Index i) {
    S.row(i).setZero();
    S.col(i).setZero();
    S(i, i) = 1.0;
  }
};

}  // namespace modebank
