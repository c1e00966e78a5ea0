// Sums of outer products and singular values, compared with the plain products.
#include "ident/fit/gram.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "ident/base/linalg.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::near;

/// The number of columns is not a multiple of a tile's columns. The rows fill several blocks or only a part of one.
/// Every third row is omitted.
TEST(WeightedGram, IsThePlainProductOfTheRowsThatAreListed) {
  for (const Index count : {1, 5, 255, 256, 257, 1000})
    for (const Index columns : {1, 3, 4, 5, 17}) {
      const Eigen::MatrixXd left = Eigen::MatrixXd::Random(count, columns), right = Eigen::MatrixXd::Random(count, 2);
      std::vector<Index> rows;
      for (Index k = 0; k < count; ++k)
        if (k % 3 != 1) rows.push_back(k);
      const Eigen::VectorXd root = Eigen::VectorXd::Random(std::ssize(rows));
      Eigen::MatrixXd Z(std::ssize(rows), columns + 2);
      Z << left(rows, Eigen::all), right(rows, Eigen::all);
      Z = root.asDiagonal() * Z;
      const Eigen::MatrixXd gram = weighted_gram(left, right, rows, root);
      EXPECT_TRUE(near(gram, Eigen::MatrixXd(Z.transpose() * Z), 1e-11)) << count << ", " << columns;
      EXPECT_EQ(gram, gram.transpose());
    }
}

/// Small and large matrices use different algorithms, so both are tested.
TEST(SingularValues, AreThoseThatTheMatrixWasMadeOf) {
  for (const Index n : {3, 23, 24, 60}) {
    const Eigen::MatrixXd U = thin_qr(Eigen::MatrixXd::Random(n, n)).Q, V = thin_qr(Eigen::MatrixXd::Random(n, n)).Q;
    Eigen::VectorXd sigma(n);
    for (Index i = 0; i < n; ++i) sigma(i) = std::pow(10.0, -6.0 * static_cast<double>(i) / static_cast<double>(n));
    EXPECT_TRUE(near(singular_values(U * sigma.asDiagonal() * V.transpose()), sigma, 1e-13)) << n;
  }
}

}  // namespace
}  // namespace modebank
