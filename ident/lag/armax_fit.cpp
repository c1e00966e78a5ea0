#include "ident/lag/armax_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ident/base/linalg.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index long_first = 33;

/// Columns of regressors and targets of the samples from `first` on: state lags, input lags, the constant, lagged
/// residuals, and last the n targets.
MatrixXd columns_of(const ArmaxStretch& stretch, const ArmaxOrder& order, const std::vector<Index>& delays,
                    Index first) {
  const Index n = stretch.y.rows(), m = stretch.u.rows(), K = stretch.y.cols() - first;
  MatrixXd columns(n * (order.state_lags + order.noise_lags + 1) + m * order.input_lags + order.has_constant(), K);
  Index at = 0;
  for (Index j = 1; j <= order.state_lags; ++j, at += n) columns.middleRows(at, n) = stretch.y.middleCols(first - j, K);
  for (Index j = 0; j < order.input_lags; ++j)
    for (Index i = 0; i < m; ++i, ++at)
      columns.row(at) = stretch.u.row(i).segment(first - delays[static_cast<std::size_t>(i)] - j, K);
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
  MatrixXd companion = MatrixXd::Zero(C.cols(), C.cols());
  companion.topRows(n) = -C;
  companion.bottomLeftCorner(C.cols() - n, C.cols() - n).setIdentity();
  const double shrunk = most_root / eigenvalues(companion).cwiseAbs().maxCoeff();
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

/// e of C(q) e = r in place, for each row, with C reversed: [C_nc .. C_1]'. n columns a sample; the first are e before.
void solve_noise(const MatrixXd& reversed, MatrixXd& r) {
  const Index s = reversed.rows(), n = reversed.cols();
  for (Index at = 0; s > 0 && at + s < r.cols(); at += n)
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < s; ++j) r.col(at + s + i) -= reversed(j, i) * r.col(at + j);
}

/// Errors and normal equations for any parameters [theta C], n x q. The nc errors before a stretch are unknown, with
/// the covariance of the others: they are what is then most probable.
class PredictionErrors {
 public:
  PredictionErrors(const ArmaxData& data, const ArmaxOrder& order, const std::vector<Index>& delays)
      : data_(data), n_(data.states()), nc_(order.noise_lags), s_(n_ * nc_), C_(s_, n_) {
    for (const ArmaxStretch& stretch : data.stretches)
      columns_.push_back(columns_of(stretch, order, delays, data.first));
    q_ = columns_.front().rows() - n_;
  }

  void set(const MatrixXd& all) {
    all_ = all;
    if (nc_ == 0) return;
    for (Index j = 0; j < nc_; ++j) C_.middleRows(j * n_, n_) = all.middleCols(q_ - (j + 1) * n_, n_).transpose();
    by_start_.setZero(s_, s_ + n_ * std::ranges::max(data_.rows));
    by_start_.leftCols(s_).setIdentity();
    solve_noise(C_, by_start_);
    Index last = by_start_.cols();
    while (last > s_ && by_start_.middleCols(last - n_, n_).cwiseAbs().maxCoeff() < 1e-9) last -= n_;
    by_start_.conservativeResize(s_, last);
  }

  /// Columns of all errors, and where those of a stretch begin: nc before its start, then one for each row.
  Index size() const { return data_.count + nc_ * std::ssize(columns_); }
  Index begin(std::size_t r) const { return data_.begin[r] + nc_ * static_cast<Index>(r); }

  /// Errors of a stretch, by weighted least squares for those before its start. They replace the lagged residuals among
  /// the regressors. `nats`, if not null, becomes what unknown errors take from the log likelihood.
  MatrixXd errors(std::size_t r, const VectorXd& weight, const MatrixXd& W, double* nats = nullptr) {
    MatrixXd& X = columns_[r];
    const Index K = X.cols(), P = q_ - s_;
    MatrixXd e = MatrixXd::Zero(1, s_ + n_ * K);
    e.rightCols(n_ * K) = (X.bottomRows(n_) - all_.leftCols(P) * X.topRows(P)).reshaped().transpose();
    solve_noise(C_, e);
    if (s_ > 0) {
      const Index faded = std::min(e.cols(), by_start_.cols());
      const VectorXd of = weight.segment(begin(r), faded / n_);
      const MatrixXd G = whitened(by_start_.leftCols(faded), of, W), information = G * G.transpose();
      const VectorXd target = G * whitened(e.leftCols(faded), of, W).transpose();
      const VectorXd start = -Cholesky(information).solve(target);
      e.leftCols(faded) += start.transpose() * by_start_.leftCols(faded);
      if (nats)
        *nats = 0.5 * ((W * start.reshaped(n_, nc_)).squaredNorm() + log_determinant(information) -
                       static_cast<double>(nc_) * log_determinant(W.transpose() * W));
    }
    const MatrixXd found = e.reshaped(n_, nc_ + K);
    for (Index j = 0; j < nc_; ++j) X.middleRows(P + j * n_, n_) = found.middleCols(nc_ - 1 - j, K);
    return found;
  }
  MatrixXd errors(const VectorXd& weight, const MatrixXd& W) {
    MatrixXd joined(n_, size());
    for (std::size_t r = 0; r < columns_.size(); ++r)
      joined.middleCols(begin(r), nc_ + data_.rows[r]) = errors(r, weight, W);
    return joined;
  }

  /// Normal equations [J J', J e] of each stretch, weighted and whitened, for derivatives J of -e and the errors e that
  /// were made last. Parameters are the rows of [theta C] one after the other.
  std::vector<MatrixXd> sums(const MatrixXd& e, const VectorXd& weight, const MatrixXd& W) const {
    std::vector<MatrixXd> sums;
    for (std::size_t r = 0; r < columns_.size(); ++r) {
      const auto rows = Eigen::seqN(begin(r) + nc_, data_.rows[r]);
      sums.push_back(sums_of(columns_[r], e(Eigen::all, rows), weight(rows), W));
    }
    return sums;
  }

 private:
  const ArmaxData& data_;
  Index n_, nc_, s_, q_ = 0;
  MatrixXd all_, C_;   // C reversed, for solve_noise
  MatrixXd by_start_;  // derivatives of errors by those before, s x s + n for each sample, until they have faded
  std::vector<MatrixXd> columns_;

  /// n columns a sample, times W, which is lower triangular, and the root of the sample's weight.
  MatrixXd whitened(const MatrixXd& of, const VectorXd& weight, const MatrixXd& W) const {
    MatrixXd white = MatrixXd::Zero(of.rows(), of.cols());
    for (Index k = 0; k < weight.size(); ++k)
      for (Index i = 0; i < n_; ++i)
        for (Index j = 0; j <= i; ++j) white.col(k * n_ + i) += std::sqrt(weight(k)) * W(i, j) * of.col(k * n_ + j);
    return white;
  }

  /// Rows of derivatives by parameters, of errors, and of derivatives by errors before; few samples at a time.
  MatrixXd sums_of(const MatrixXd& X, const MatrixXd& e, const VectorXd& weight, const MatrixXd& W) const {
    constexpr Index most = 256;
    const Index p = n_ * q_, all = p + 1 + s_;
    MatrixXd sums = MatrixXd::Zero(all, all), J, past = MatrixXd::Zero(all, s_);
    past.bottomRows(s_) = -MatrixXd::Identity(s_, s_);
    for (Index from = 0, count = 0; from < e.cols(); from += count) {
      count = std::min(most, e.cols() - from);
      const Index rows = s_ + n_ * from < by_start_.cols() ? all : p + 1;
      J.setZero(rows, s_ + n_ * count);
      J.leftCols(s_) = past.topRows(rows);
      for (Index i = 0; i < n_; ++i)
        J.middleRows(i * q_, q_)(Eigen::all, Eigen::seqN(s_ + i, count, n_)) = X.block(0, from, q_, count);
      solve_noise(C_, J);
      past = J.rightCols(s_);
      J.row(p).tail(n_ * count) = e.middleCols(from, count).reshaped().transpose();
      sums.topLeftCorner(rows, rows)
          .selfadjointView<Eigen::Lower>()
          .rankUpdate(whitened(J.rightCols(n_ * count), weight.segment(from, count), W));
    }
    for (Index j = p + 1; j < all; j += n_) sums.block(j, j, n_, n_) += W.transpose() * W;
    sums = MatrixXd(sums.selfadjointView<Eigen::Lower>());
    // Errors before the start are eliminated; at their estimate they leave J e as it is.
    const MatrixXd cross = sums.bottomLeftCorner(s_, p);
    if (s_ > 0)
      sums.topLeftCorner(p, p) -= cross.transpose() * Cholesky(sums.bottomRightCorner(s_, s_)).inverse() * cross;
    return sums.topLeftCorner(p, p + 1);
  }
};

MatrixXd total(const std::vector<MatrixXd>& sums) {
  return std::accumulate(sums.begin() + 1, sums.end(), sums.front());
}

VectorXd step_of(const MatrixXd& sum) { return solve_scaled(sum.leftCols(sum.rows()), sum.rightCols(1)); }

MatrixXd stepped(const MatrixXd& all, const VectorXd& step, Index noise_lags) {
  return bounded(all + step.reshaped(all.cols(), all.rows()).transpose(), noise_lags);
}

/// Gauss-Newton with halving, and the errors. Weights and the covariance are those at the begin of a step.
MatrixXd descend(PredictionErrors& equations, MatrixXd& all, Index noise_lags) {
  constexpr int most_steps = 15;
  constexpr double tolerance = 1e-9;  // of log det
  equations.set(all);
  MatrixXd errors = equations.errors(VectorXd::Ones(equations.size()), MatrixXd::Identity(all.rows(), all.rows()));
  for (int steps = 0; steps < most_steps; ++steps) {
    const VectorXd weight = huber(errors).weight;
    const MatrixXd W = whitening(mean_product(errors, weight));
    errors = equations.errors(weight, W);
    const double value = log_determinant(mean_product(errors, weight));
    const MatrixXd sum = total(equations.sums(errors, weight, W));
    const VectorXd step = step_of(sum);
    if (!(step.dot(sum.rightCols(1).reshaped()) > tolerance * static_cast<double>(errors.cols()))) break;
    double gained = 0.0;
    for (double h = 1.0; h > 1e-3 && !(gained > 0.0); h /= 2.0) {
      const MatrixXd next = stepped(all, h * step, noise_lags);
      equations.set(next);
      const MatrixXd next_errors = equations.errors(weight, W);
      gained = value - log_determinant(mean_product(next_errors, weight));
      if (!(gained > 0.0)) continue;
      all = next;
      errors = next_errors;
    }
    if (!(gained > tolerance)) break;
  }
  equations.set(all);
  return errors;
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
  const auto lags = [&](double all) { return std::max<Index>(4, static_cast<Index>(all * share)); };
  const ArmaxOrder order{data.differences, lags(20.0), lags(30.0), 0};
  const Index n = data.states();
  const MatrixXd theta = coefficients(armax_gram(data, order, least_delay, long_first), n);
  for (ArmaxStretch& stretch : data.stretches) {
    const MatrixXd columns = columns_of(stretch, order, least_delay, long_first);
    stretch.residuals.setZero(n, stretch.y.cols());
    stretch.residuals.rightCols(columns.cols()) = columns.bottomRows(n) - theta * columns.topRows(theta.cols());
  }
}

ArmaxFit fit_armax(const ArmaxData& data, const ArmaxOrder& order, const std::vector<Index>& delays,
                   LeftOut* left_out) {
  const Index n = data.states(), nc = order.noise_lags;
  PredictionErrors equations(data, order, delays);
  MatrixXd all = bounded(coefficients(armax_gram(data, order, delays, data.first), n), nc);
  MatrixXd errors = descend(equations, all, nc);
  const Weighted robust = huber(errors);
  ArmaxFit fit{order, delays, all.leftCols(all.cols() - n * nc), all.rightCols(n * nc), {}, {}, data.count};
  fit.S = robust.S * (static_cast<double>(errors.cols()) / static_cast<double>(data.count - all.cols()));
  const MatrixXd W = whitening(fit.S);
  errors = equations.errors(robust.weight, W);
  const std::vector<MatrixXd> sums = equations.sums(errors, robust.weight, W);
  const MatrixXd sum = total(sums);
  const Eigen::ArrayXd w = robust.weight.array(), size = (W * errors).colwise().squaredNorm().transpose().array();
  fit.covariance = solve_scaled(sum.leftCols(sum.rows()), MatrixXd::Identity(sum.rows(), sum.rows())) *
                   (w.mean() * (w.square() * size).mean() / (w * size).mean() / robust.inside);
  if (!left_out) return fit;
  constexpr Index folds = 5;
  // The step is not halved: a structure that is not determined without a fold must lose.
  left_out->errors.resize(n, data.count);
  left_out->start_nats.setZero(std::ssize(sums));
  for (Index fold = 0; fold < folds; ++fold) {
    MatrixXd kept = sum;
    const auto left = [&](std::size_t r) { return data.stretches[r].part % folds == fold; };
    for (std::size_t r = 0; r < sums.size(); ++r)
      if (left(r)) kept -= sums[r];
    equations.set(stepped(all, step_of(kept), nc));
    for (std::size_t r = 0; r < sums.size(); ++r)
      if (left(r))
        left_out->errors.middleCols(data.begin[r], data.rows[r]) =
            equations.errors(r, robust.weight, W, &left_out->start_nats(static_cast<Index>(r))).rightCols(data.rows[r]);
  }
  return fit;
}

}  // namespace modebank
