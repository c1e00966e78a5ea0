#pragma once

#include <Eigen/Core>

#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"

namespace modebank {

/// The candidate terms: products up to degree three, magnitudes and hinges. Their variables are at most eight
/// regressors and four directions of the linear fit. Hinges have 13 quantiles as knots.
///
/// Regressors are chosen one after another; each new regressor explains the most of the remaining increments. The
/// increment of a state gives several directions: the part from inputs of all lags, the whole increment, and the parts
/// from each of the newest two input samples. Directions matter because a saturation acts on a sum of inputs b'u, not
/// on a single input.
///
/// `regressors`: N x q; `fit`: q x n, the linear fit; `targets`: N x n, the values to be explained.
MotionTerms make_dictionary(const LinearStructure& structure, const Eigen::MatrixXd& regressors,
                            const Eigen::MatrixXd& fit, const Eigen::MatrixXd& targets);

/// Largest number of candidate terms.
inline constexpr Eigen::Index most_dictionary_terms = 12 * 15 + 78 + 364;

}  // namespace modebank
