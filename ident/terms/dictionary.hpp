#pragma once

#include <Eigen/Core>

#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"

namespace modebank {

/// The terms that are tried: products up to degree three, magnitudes and hinges at 13 quantiles of at most eight
/// regressors and four directions of the linear fit. Regressors are those that, one after another, explain most of the
/// increments. Directions are the inputs' part of a state's increment with all lags, the whole increment, and the
/// inputs' part of the newest two input samples, each alone: a saturation bends b'u and no single input.
///
/// `regressors`: N x q; `fit`: q x n, the linear fit; `targets`: N x n, what is to be explained.
MotionTerms make_dictionary(const LinearStructure& structure, const Eigen::MatrixXd& regressors,
                            const Eigen::MatrixXd& fit, const Eigen::MatrixXd& targets);

/// The most terms that it has.
inline constexpr Eigen::Index most_dictionary_terms = 12 * 15 + 78 + 364;

}  // namespace modebank
