#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace modebank::test {

/// Passes if shapes agree and every entry differs by at most `tolerance` (NaN equals NaN). The message of a failure
/// shows the entry.
inline ::testing::AssertionResult near(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected,
                                       double tolerance) {
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols())
    return ::testing::AssertionFailure() << "shape " << actual.rows() << " x " << actual.cols() << ", expected "
                                         << expected.rows() << " x " << expected.cols();
  for (Eigen::Index j = 0; j < actual.cols(); ++j)
    for (Eigen::Index i = 0; i < actual.rows(); ++i) {
      const double a = actual(i, j), e = expected(i, j);
      if (std::isnan(a) && std::isnan(e)) continue;
      if (!(std::abs(a - e) <= tolerance))
        return ::testing::AssertionFailure() << "at (" << i << ", " << j << "): " << a << ", expected " << e
                                             << ", difference " << a - e << ", tolerance " << tolerance;
    }
  return ::testing::AssertionSuccess();
}

}  // namespace modebank::test
