#include "ident/model/residual_tests.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "ident/base/distributions.hpp"
#include "ident/base/lagged_product.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A series about its mean, with zeros in place of values that are not finite. Also the sum of its squares.
struct Centred {
  ArrayXd values;
  double square_sum = 0.0;
  Index finite = 0;

  explicit Centred(ArrayXd series) : values(std::move(series)) {
    const auto known = values.isFinite();
    finite = known.count();
    const double mean = known.select(values, 0.0).sum() / static_cast<double>(std::max<Index>(finite, 1));
    // Deviations of a constant series are rounding errors of its mean.
    const double constant = 1e-12 * std::abs(mean);
    values = (known && (values - mean).abs() > constant).select(values - mean, 0.0).eval();
    square_sum = values.square().sum();
  }
};

/// Correlation of `a` with `b` lagged by `lag` samples, for lags 0 .. lags; NaN if a series is constant.
VectorXd correlations(const Centred& a, const Centred& b, Index lags) {
  const double scale = std::sqrt(a.square_sum) * std::sqrt(b.square_sum);
  if (!(scale > 0.0)) return VectorXd::Constant(lags + 1, not_a_number);
  VectorXd result(lags + 1);
  for (Index lag = 0; lag <= lags; ++lag) result(lag) = lagged_product(a.values, b.values, lag) / scale;
  return result;
}

/// P of residual_tests.hpp, from the autocorrelations of both series.
double bartlett_variance(const VectorXd& a, const VectorXd& b) {
  double P = 1.0;
  for (Index k = 1; k < a.size(); ++k)
    P += 2.0 * (1.0 - static_cast<double>(k) / static_cast<double>(a.size())) * a(k) * b(k);
  return P;
}

void check(const MatrixXd& residual, const MatrixXd& input, const ResidualTestOptions& options) {
  if (residual.rows() < 1 || residual.cols() != input.cols())
    throw std::invalid_argument("residual tests need residuals and inputs with the same number of samples");
  if (options.lags < 1) throw std::invalid_argument("residual tests need at least one lag");
  if (!(options.level > 0.0 && options.level < 1.0))
    throw std::invalid_argument("the level of a band lies between 0 and 1");
}

Index finite_samples(const MatrixXd& residual) {
  Index count = 0;
  for (Index k = 0; k < residual.cols(); ++k) count += residual.col(k).allFinite() ? 1 : 0;
  return count;
}

std::vector<Centred> centred_rows(const MatrixXd& rows) {
  std::vector<Centred> result;
  for (Index i = 0; i < rows.rows(); ++i) result.emplace_back(rows.row(i).transpose().array());
  return result;
}

}  // namespace

double ljung_box_p(const VectorXd& autocorrelation, Index N) {
  const Index lags = std::min(autocorrelation.size() - 1, N / 5);
  if (lags < 1 || !autocorrelation.allFinite()) return not_a_number;
  double Q = 0.0;
  for (Index k = 1; k <= lags; ++k) Q += autocorrelation(k) * autocorrelation(k) / static_cast<double>(N - k);
  return chi_square_upper_tail(static_cast<double>(N) * static_cast<double>(N + 2) * Q, static_cast<double>(lags));
}

ResidualTests test_residuals(const MatrixXd& residual, const MatrixXd& input, const ResidualTestOptions& options) {
  check(residual, input, options);
  const Index n = residual.rows(), m = input.rows(),
              lags = std::max<Index>(std::min(options.lags, residual.cols() - 1), 0);
  const double z = normal_quantile(0.5 * (1.0 + options.level));
  const std::vector<Centred> e = centred_rows(residual), u = centred_rows(input);
  std::vector<VectorXd> input_autocorrelation;
  for (const Centred& channel : u) input_autocorrelation.push_back(correlations(channel, channel, lags));

  ResidualTests tests;
  tests.level = options.level;
  tests.samples = finite_samples(residual);
  const double root_N = std::sqrt(static_cast<double>(tests.samples));
  tests.autocorrelation_band = z / root_N;
  tests.autocorrelation.resize(n, lags + 1);
  tests.cross_correlation.resize(n * m, lags + 1);
  tests.cross_correlation_band.resize(m, n);
  tests.ljung_box_p.resize(n);
  for (Index i = 0; i < n; ++i) {
    const Centred& series = e[static_cast<std::size_t>(i)];
    const VectorXd rho = correlations(series, series, lags);
    tests.autocorrelation.row(i) = rho.transpose();
    tests.ljung_box_p(i) = ljung_box_p(rho, series.finite);
    for (Index j = 0; j < m; ++j) {
      const auto channel = static_cast<std::size_t>(j);
      tests.cross_correlation.row(i * m + j) = correlations(series, u[channel], lags).transpose();
      tests.cross_correlation_band(j, i) =
          z * std::sqrt(bartlett_variance(rho, input_autocorrelation[channel])) / root_N;
    }
  }
  return tests;
}

ResidualTests test_residuals(const Trajectory& run, const LinearStructure& structure, const VectorXd& theta,
                             const ResidualTestOptions& options) {
  const Transitions t = stack_transitions(run, 0, run.transitions(), structure);
  const MatrixXd residual = t.increments - t.regressors * theta.reshaped(structure.regressors(), structure.states);
  return test_residuals(residual.transpose(), run.input.leftCols(run.transitions()), options);
}

}  // namespace modebank
