#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Statistics of the finite values of each row.
struct Spread {
  Eigen::VectorXd mean, squares, low, high, count;  ///< squares: sum of those of the distances to the mean

  explicit Spread(Eigen::Index rows)
      : mean(Eigen::VectorXd::Zero(rows)),
        squares(mean),
        low(Eigen::VectorXd::Constant(rows, INFINITY)),
        high(-low),
        count(mean) {}
  void add(const Eigen::MatrixXd& values) {
    for (Eigen::Index k = 0; k < values.cols(); ++k)
      for (Eigen::Index i = 0; i < values.rows(); ++i) {
        const double value = values(i, k), from = value - mean(i);
        if (!std::isfinite(value)) continue;
        mean(i) += from / ++count(i);
        squares(i) += from * (value - mean(i));
        low(i) = std::min(low(i), value);
        high(i) = std::max(high(i), value);
      }
  }
  Eigen::VectorXd deviation() const { return (squares.array() / count.array().max(1.0)).sqrt(); }
};

/// Where one linear model was learned: "means: T 31.9 degC, heater 20.1 W; T 19.98 degC at zero input". The state at
/// zero input is left out where it would be extrapolated: where zero lies outside the range of an input, where a model
/// has no constant or may not settle. Empty without training runs, and for more than four columns.
std::string operating_words(const Bank& single, const Recording& recording);

/// Where the single linear model is one of differences: "the level of T wanders or differs by run (sd 5 K): something
/// that acts is not logged". The standard deviation is that of the states less the response to the inputs and less the
/// sensor noise, without the beginnings of runs, which are not at rest. Else empty.
std::string level_doubt(const Archive& archive);

}  // namespace modebank::app
