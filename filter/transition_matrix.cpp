#include "filter/transition_matrix.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace modebank {

TransitionMatrix::TransitionMatrix(Eigen::MatrixXd row_stochastic) : matrix_(std::move(row_stochastic)) {
  constexpr double row_sum_tolerance = 1e-9;
  if (matrix_.rows() != matrix_.cols() || matrix_.rows() == 0)
    throw std::invalid_argument("transition matrix is " + std::to_string(matrix_.rows()) + " x " +
                                std::to_string(matrix_.cols()) + ", must be square and not empty");
  for (Eigen::Index i = 0; i < matrix_.rows(); ++i) {
    const double sum = matrix_.row(i).sum();
    if (!(std::abs(sum - 1.0) <= row_sum_tolerance))
      throw std::invalid_argument("row " + std::to_string(i) + " of the transition matrix sums to " +
                                  std::to_string(sum) + ", must be 1");
    if (!(matrix_.row(i).minCoeff() >= 0.0))
      throw std::invalid_argument("row " + std::to_string(i) + " of the transition matrix holds the negative entry " +
                                  std::to_string(matrix_.row(i).minCoeff()));
    // A row that was normalised before keeps its bits, so that a stored bank filters as the original did.
    const double rounding = 2.0 * std::numeric_limits<double>::epsilon() * static_cast<double>(matrix_.cols());
    if (std::abs(sum - 1.0) > rounding) matrix_.row(i) /= sum;
  }
}

TransitionMatrix TransitionMatrix::sticky(Eigen::Index modes, double stay) {
  if (modes < 1) throw std::invalid_argument("a transition matrix of " + std::to_string(modes) + " modes");
  if (!(stay >= 0.0 && stay <= 1.0))
    throw std::invalid_argument("stay is " + std::to_string(stay) + ", must be a probability");
  if (modes == 1) return {};
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(modes, modes, (1.0 - stay) / static_cast<double>(modes - 1));
  matrix.diagonal().setConstant(stay);
  return TransitionMatrix(std::move(matrix));
}

}  // namespace modebank
