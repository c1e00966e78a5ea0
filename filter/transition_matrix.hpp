#pragma once

#include <Eigen/Core>

namespace modebank {

/// Row-stochastic mode transition matrix, T(i, j) = P(mode j next | mode i now). A type of its own, so that it can
/// never be handed over where mixing weights (columns sum to one) are meant. Checked once, at construction.
class TransitionMatrix {
 public:
  TransitionMatrix() : matrix_(Eigen::MatrixXd::Identity(1, 1)) {}
  /// Throws std::invalid_argument unless square with nonnegative rows that each sum to one within 1e-9 (rows are then
  /// normalised, unless they are already up to rounding: making one from its own matrix() keeps every bit).
  explicit TransitionMatrix(Eigen::MatrixXd row_stochastic);
  /// `stay` on the diagonal, the rest spread equally; K = 1 gives 1.
  static TransitionMatrix sticky(Eigen::Index modes, double stay);

  Eigen::Index modes() const { return matrix_.rows(); }
  const Eigen::MatrixXd& matrix() const { return matrix_; }

 private:
  Eigen::MatrixXd matrix_;
};

}  // namespace modebank
