#include "ident/lag/armax_fit.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/linalg.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index long_first = 33;

/// Columns of regressors and targets of the samples from `first` on: state lags, lags of each input, the constant,
/// lagged residuals, and last the n targets.
MatrixXd columns_of(const ArmaxStretch& stretch, const ArmaxOrder& order, const std::vector<Index>& delays,
                    Index first) {
  const Index n = stretch.y.rows(), m = stretch.u.rows(), K = stretch.y.cols() - first;
  MatrixXd columns(n * (order.state_lags + order.noise_lags + 1) + m * order.input_lags + order.has_constant(), K);
  Index at = 0;
  for (Index j = 1; j <= order.state_lags; ++j, at += n) columns.middleRows(at, n) = stretch.y.middleCols(first - j, K);
  for (Index i = 0; i < m; ++i)
    for (Index j = delays[static_cast<std::size_t>(i)], end = j + order.input_lags; j < end; ++j, ++at)
      columns.row(at) = stretch.u.row(i).segment(first - j, K);
  if (order.has_constant()) columns.row(at++).setOnes();
  for (Index j = 1; j <= order.noise_lags; ++j, at += n)
    columns.middleRows(at, n) = stretch.residuals.middleCols(first - j, K);
  columns.bottomRows(n) = stretch.y.rightCols(K);
  return columns;
}

/// n x q coefficients of the targets, the last n columns of a Gram matrix.
MatrixXd coefficients(const MatrixXd& gram, Index n) {
  const Index q = gram.rows() - n;
  return solve_scaled(gram.topLeftCorner(q, q), gram.topRightCorner(q, n)).transpose();
}

/// [theta C] with the roots of C shrunk to .995 where they are larger.
MatrixXd bounded(MatrixXd all, Index noise_lags) {
  constexpr double most_root = 0.995;
  if (noise_lags == 0) return all;
  const Index n = all.rows();
  auto C = all.rightCols(n * noise_lags);
  const double shrunk = most_root / roots_of(-C).cwiseAbs().maxCoeff();
  for (Index j = 0; j < noise_lags && shrunk < 1.0; ++j)
    C.middleCols(j * n, n) *= std::pow(shrunk, static_cast<double>(j + 1));
  return all;
}

/// W with W' W = S^-1.
MatrixXd whitening(const MatrixXd& S) { return Cholesky(S).inverse_root().transpose(); }

/// Positive definite even if all errors are zero.
MatrixXd mean_product(const MatrixXd& e, const VectorXd& weight) {
  constexpr double tiny = 1e-200;
  const MatrixXd sum = e * weight.asDiagonal() * e.transpose();
  return sum / static_cast<double>(e.cols()) + tiny * MatrixXd::Identity(e.rows(), e.rows());
}

/// Huber's weights of rows, and the covariance of errors that they give.
struct Weighted {
  VectorXd weight;
  double inside = 1.0;  ///< mean derivative of weighted errors: Gaussian errors have mean(w e e') = inside S
  MatrixXd S;
};

/// Weights are one unless a standard deviation exceeds the scale by the median by more than a fifth: rounding and
/// Gaussian tails must not cost efficiency.
Weighted huber(const MatrixXd& errors) {
  constexpr double k = huber_tuning, most_ratio = 1.2;
  const Index n = errors.rows();
  Weighted result{VectorXd::Ones(errors.cols()), 1.0, {}};
  result.S = mean_product(errors, result.weight);
  const MatrixXd z = (whitening(result.S) * errors).cwiseAbs();
  VectorXd scale(n);
  for (Index i = 0; i < n; ++i) scale(i) = std::max(0.1, mad_to_sd * median(z.row(i).transpose()));
  if (scale.minCoeff() > 1.0 / most_ratio) return result;
  const Eigen::ArrayXd largest = (scale.cwiseInverse().asDiagonal() * z).colwise().maxCoeff().transpose();
  const Eigen::ArrayXd weight = k / largest.max(k);
  result.inside = (largest <= k).select(1.0, weight * static_cast<double>(n - 1) / static_cast<double>(n)).mean();
  result.weight = weight;
  result.S = mean_product(errors, weight) / result.inside;
  return result;
}

struct NormalSums {
  MatrixXd JJ;
  VectorXd Je;
};

NormalSums total(const std::vector<NormalSums>& sums) {
  NormalSums all = sums.front();
  for (std::size_t r = 1; r < sums.size(); ++r) all.JJ += sums[r].JJ, all.Je += sums[r].Je;
  return all;
}

/// Errors and normal equations for any parameters [theta C], n x q.
class PredictionErrors {
 public:
  PredictionErrors(const ArmaxData& data, const ArmaxOrder& order, const std::vector<Index>& delays)
      : data_(data), n_(data.states()), nc_(order.noise_lags) {
    for (const ArmaxStretch& stretch : data.stretches)
      columns_.push_back(columns_of(stretch, order, delays, data.first));
    q_ = columns_.front().rows() - n_;
  }

  /// Errors of a stretch. They replace the lagged residuals among its regressors, except those before its start.
  MatrixXd errors(std::size_t stretch, const MatrixXd& all) {
    MatrixXd& X = columns_[stretch];
    const Index P = q_ - nc_ * n_;
    MatrixXd e = X.bottomRows(n_);
    e.noalias() -= all.leftCols(P) * X.topRows(P);
    for (Index k = 0; nc_ > 0 && k < e.cols(); ++k) {
      for (Index j = 0; j < std::min(k, nc_); ++j) X.col(k).segment(P + j * n_, n_) = e.col(k - 1 - j);
      e.col(k) -= all.rightCols(nc_ * n_).lazyProduct(X.col(k).segment(P, nc_ * n_));
    }
    return e;
  }
  MatrixXd errors(const MatrixXd& all) {
    MatrixXd joined(n_, data_.count);
    for (std::size_t r = 0; r < columns_.size(); ++r) joined.middleCols(data_.begin[r], data_.rows[r]) = errors(r, all);
    return joined;
  }

  /// Sums of each stretch over derivatives J of -e, weighted and whitened. Parameters are the rows of [theta C] one
  /// after the other.
  std::vector<NormalSums> sums(const MatrixXd& all, const VectorXd& weight, const MatrixXd& W) {
    std::vector<NormalSums> sums;
    for (std::size_t r = 0; r < columns_.size(); ++r) {
      const MatrixXd e = W * errors(r, all);
      sums.push_back(sums_of(columns_[r], e, all, weight.segment(data_.begin[r], data_.rows[r]).cwiseSqrt(), W));
    }
    return sums;
  }

 private:
  const ArmaxData& data_;
  Index n_, nc_, q_ = 0;
  std::vector<MatrixXd> columns_;

  /// Derivatives of few samples are held at a time, n columns for each, after those of the nc samples before.
  NormalSums sums_of(const MatrixXd& X, const MatrixXd& e, const MatrixXd& all, const VectorXd& root,
                     const MatrixXd& W) const {
    constexpr Index most = 256;
    const Index p = n_ * q_;
    NormalSums sums{MatrixXd::Zero(p, p), VectorXd::Zero(p)};
    MatrixXd J = MatrixXd::Zero(p, n_ * (nc_ + most)), white(p, n_ * most);
    for (Index from = 0; from < e.cols(); from += most) {
      const Index count = std::min(most, e.cols() - from);
      for (Index k = 0; k < count; ++k) {
        auto now = J.middleCols(n_ * (nc_ + k), n_);
        now.setZero();
        for (Index i = 0; i < n_; ++i) now.col(i).segment(i * q_, q_) = X.col(from + k).head(q_);
        for (Index j = 1; j <= nc_; ++j)
          now -=
              J.middleCols(n_ * (nc_ + k - j), n_).lazyProduct(all.middleCols(q_ - (nc_ + 1 - j) * n_, n_).transpose());
        white.middleCols(n_ * k, n_) = now.lazyProduct(W.transpose() * root(from + k));
      }
      const MatrixXd target = e.middleCols(from, count) * root.segment(from, count).asDiagonal();
      sums.JJ.selfadjointView<Eigen::Lower>().rankUpdate(white.leftCols(n_ * count));
      sums.Je.noalias() += white.leftCols(n_ * count) * target.reshaped();
      J.leftCols(n_ * nc_) = J.middleCols(n_ * count, n_ * nc_).eval();
    }
    sums.JJ = MatrixXd(sums.JJ.selfadjointView<Eigen::Lower>());
    return sums;
  }
};

MatrixXd stepped(const MatrixXd& all, const VectorXd& step, Index noise_lags) {
  return bounded(all + step.reshaped(all.cols(), all.rows()).transpose(), noise_lags);
}

/// Gauss-Newton with halving. Weights are those of the errors at the begin of a step.
MatrixXd descend(PredictionErrors& equations, MatrixXd all, Index noise_lags) {
  constexpr int most_steps = 15;
  constexpr double tolerance = 1e-9;  // of log det
  MatrixXd errors = equations.errors(all);
  for (int steps = 0; steps < most_steps; ++steps) {
    const VectorXd weight = huber(errors).weight;
    const MatrixXd S = mean_product(errors, weight);
    const NormalSums sum = total(equations.sums(all, weight, whitening(S)));
    const VectorXd step = solve_scaled(sum.JJ, sum.Je);
    if (!(step.dot(sum.Je) > tolerance * static_cast<double>(errors.cols()))) break;
    double gained = 0.0;
    for (double h = 1.0; h > 1e-3 && !(gained > 0.0); h /= 2.0) {
      const MatrixXd next = stepped(all, h * step, noise_lags);
      MatrixXd next_errors = equations.errors(next);
      gained = log_determinant(S) - log_determinant(mean_product(next_errors, weight));
      if (gained > 0.0) all = next, errors = std::move(next_errors);
    }
    if (!(gained > tolerance)) break;
  }
  return all;
}

}  // namespace

MatrixXd armax_gram(const ArmaxData& data, const ArmaxOrder& order, const std::vector<Index>& delays, Index first) {
  MatrixXd gram;
  for (const ArmaxStretch& stretch : data.stretches) {
    const MatrixXd columns = columns_of(stretch, order, delays, first);
    if (gram.size() == 0) gram.setZero(columns.rows(), columns.rows());
    gram.selfadjointView<Eigen::Lower>().rankUpdate(columns);
  }
  return gram.selfadjointView<Eigen::Lower>();
}

MatrixXd solve_scaled(const MatrixXd& xx, const MatrixXd& xz) {
  constexpr double rounding = 1e-13;
  const auto scale = (xx.diagonal().array().max(0.0).sqrt() + 1e-150).inverse().matrix().eval();
  const SymmetricEigen gram = symmetric_eigen(scale.asDiagonal() * xx * scale.asDiagonal());
  const VectorXd inverse =
      (gram.values.array() > rounding * gram.values.maxCoeff()).select(gram.values.cwiseInverse(), 0.0);
  const MatrixXd turned = scale.asDiagonal() * gram.vectors;
  return turned * (inverse.asDiagonal() * (turned.transpose() * xz));
}

void add_residuals(ArmaxData& data, const std::vector<Index>& least_delay) {
  // Few rows get fewer lags: residuals of a fit that has as many parameters as rows would be zero.
  const auto most = static_cast<double>(20 * data.states() + 30 * data.inputs() + 1);
  const double share = std::min(1.0, static_cast<double>(data.count) / most / 4.0);
  ArmaxOrder order{data.differences, 4, 4, 0};
  order.state_lags = std::max(order.state_lags, static_cast<Index>(20.0 * share));
  order.input_lags = std::max(order.input_lags, static_cast<Index>(30.0 * share));
  const Index n = data.states();
  const MatrixXd theta = coefficients(armax_gram(data, order, least_delay, long_first), n);
  for (ArmaxStretch& stretch : data.stretches) {
    const MatrixXd columns = columns_of(stretch, order, least_delay, long_first);
    stretch.residuals.setZero(n, stretch.y.cols());
    stretch.residuals.rightCols(columns.cols()) = columns.bottomRows(n) - theta * columns.topRows(theta.cols());
  }
}

Eigen::VectorXcd roots_of(const MatrixXd& blocks) {
  const Index n = blocks.rows(), size = blocks.cols();
  MatrixXd companion = MatrixXd::Zero(size, size);
  companion.topRows(n) = blocks;
  companion.bottomLeftCorner(size - n, size - n).setIdentity();
  return eigenvalues(companion);
}

ArmaxFit fit_armax(const ArmaxData& data, const ArmaxOrder& order, const std::vector<Index>& delays,
                   MatrixXd* left_out) {
  const Index n = data.states(), nc = order.noise_lags;
  PredictionErrors equations(data, order, delays);
  const MatrixXd all =
      descend(equations, bounded(coefficients(armax_gram(data, order, delays, data.first), n), nc), nc);
  ArmaxFit fit{order, delays, all.leftCols(all.cols() - n * nc), {}, {}, {}, data.count};
  for (Index j = nc; j > 0; --j) fit.C.push_back(all.middleCols(all.cols() - j * n, n));
  const MatrixXd errors = equations.errors(all);
  const Weighted robust = huber(errors);
  fit.S = robust.S * (static_cast<double>(data.count) / static_cast<double>(data.count - all.cols()));
  const MatrixXd W = whitening(fit.S);
  const std::vector<NormalSums> sums = equations.sums(all, robust.weight, W);
  const NormalSums sum = total(sums);
  const Eigen::ArrayXd w = robust.weight.array(), size = (W * errors).colwise().squaredNorm().transpose().array();
  fit.covariance = solve_scaled(sum.JJ, MatrixXd::Identity(sum.JJ.rows(), sum.JJ.rows())) *
                   (w.mean() * (w.square() * size).mean() / (w * size).mean() / robust.inside);
  if (!left_out) return fit;
  constexpr Index folds = 5;
  // The step is not halved: a structure that is not determined without a fold must lose.
  left_out->resize(n, data.count);
  for (Index fold = 0; fold < folds; ++fold) {
    NormalSums kept = sum;
    const auto left = [&](std::size_t r) { return data.stretches[r].part % folds == fold; };
    for (std::size_t r = 0; r < sums.size(); ++r)
      if (left(r)) kept.JJ -= sums[r].JJ, kept.Je -= sums[r].Je;
    const MatrixXd part = stepped(all, solve_scaled(kept.JJ, kept.Je), nc);
    for (std::size_t r = 0; r < sums.size(); ++r)
      if (left(r)) left_out->middleCols(data.begin[r], data.rows[r]) = equations.errors(r, part);
  }
  return fit;
}

}  // namespace modebank
