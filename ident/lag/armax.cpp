#include "ident/lag/armax.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/linalg.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns of all samples: state lags, input lags, the constant, lagged residuals.
MatrixXd regressors(const ArmaxSamples& samples, const ArmaxStructure& structure) {
  const ArmaxOrder& order = structure.order;
  const Index n = samples.y.rows(), m = samples.u.rows(), N = samples.y.cols();
  MatrixXd X =
      MatrixXd::Zero(n * (order.state_lags + order.noise_lags) + m * order.input_lags + order.has_constant(), N);
  Index at = 0;
  const auto put = [&](const auto& signal, Index lag) {
    X.block(at, lag, signal.rows(), N - lag) = signal.leftCols(N - lag);
    at += signal.rows();
  };
  for (Index j = 1; j <= order.state_lags; ++j) put(samples.y, j);
  for (Index j = 0; j < order.input_lags; ++j)
    for (Index i = 0; i < m; ++i) put(samples.u.row(i), structure.delays[static_cast<std::size_t>(i)] + j);
  if (order.has_constant()) X.row(at++).setOnes();
  for (Index j = 1; j <= order.noise_lags; ++j) put(samples.residuals, j);
  return X;
}

/// M^-1 b. What only rounding tells apart gets small coefficients.
MatrixXd solve(MatrixXd M, const MatrixXd& b) {
  constexpr double ridge = 1e-12;
  M.diagonal() *= 1.0 + ridge;
  return solve_semidefinite(M, b);
}

/// Coefficients of the states of some rows by their regressors.
MatrixXd regression(const ArmaxSamples& samples, const MatrixXd& X, const std::vector<Index>& rows) {
  const MatrixXd x = X(Eigen::all, rows);
  return solve(x * x.transpose(), x * samples.y(Eigen::all, rows).transpose()).transpose();
}

/// Fits one structure. Parameters are [theta C], n x q. The nc errors before a stretch are unknown, with the covariance
/// of the others: they are what is then most probable.
class Fitter {
 public:
  Fitter(const ArmaxSamples& samples, const ArmaxStructure& structure)
      : samples_(samples),
        structure_(structure),
        n_(samples.y.rows()),
        nc_(structure.order.noise_lags),
        X_(regressors(samples, structure)) {
    for (std::size_t i = 0; i < samples.rows.size(); ++i) {
      if (i == 0 || samples.rows[i] != samples.rows[i - 1] + 1) stretches_.push_back({samples.rows[i], 0, i});
      ++stretches_.back().count;
    }
    all_ = bounded(regression(samples, X_, samples.rows));
    descend();
  }

  ArmaxFit fit(bool leave_out) {
    const Index s = n_ * nc_;
    const VectorXd weight = weights();
    const auto K = static_cast<double>(samples_.count()), used = count(weight);
    const double inside = static_cast<double>((weight.array() == 1.0).count()) / used;
    ArmaxFit fit{structure_, all_.leftCols(X_.rows() - s), all_.rightCols(s), {}, {}, samples_.count()};
    // Of Gaussian errors, mean(w e e') is S times the mean derivative of weighted errors, the share inside.
    fit.S = covariance(errors_, weight) * (used / inside / (K - static_cast<double>(X_.rows())));
    const MatrixXd W = whitening(fit.S);
    errors_ = errors(all_, weight, W);
    const MatrixXd JJ = left_side(equations({weight}, W).front());
    fit.covariance = solve(JJ, MatrixXd::Identity(JJ.rows(), JJ.rows())) * (weight(samples_.rows).mean() / inside);
    if (leave_out) fit.left_out = left_out(weight, W);
    return fit;
  }

 private:
  struct Stretch {
    Index first, count;  // samples
    std::size_t first_row;
    double nats = 0.0;  // what unknown errors before it take from the log likelihood
  };
  const ArmaxSamples& samples_;
  const ArmaxStructure& structure_;
  Index n_, nc_;  // states, noise lags
  std::vector<Stretch> stretches_ = {};
  MatrixXd X_, all_ = {};
  MatrixXd errors_ = MatrixXd::Zero(n_, X_.cols());  // of all samples
  MatrixXd by_start_ = {};  // derivatives of errors by those before, n columns a sample, until they have faded

  static MatrixXd whitening(const MatrixXd& S) { return Cholesky(S).inverse_root().transpose(); }
  static double count(const VectorXd& weight) { return static_cast<double>((weight.array() > 0.0).count()); }
  /// Positive definite even if all errors are zero.
  static MatrixXd covariance(const MatrixXd& e, const VectorXd& weight) {
    const MatrixXd sum = e * weight.asDiagonal() * e.transpose();
    return sum / count(weight) + 1e-200 * MatrixXd::Identity(e.rows(), e.rows());
  }

  /// Scores each part by one further step without its fold, not halved: a structure that is not determined without it
  /// must lose.
  LeftOutForecast left_out(const VectorXd& weight, const MatrixXd& W) {
    constexpr Index folds = 5;
    const auto fold_of = [&](std::size_t row) { return samples_.parts.part[row] % folds; };
    std::vector<VectorXd> kept(folds, weight);
    for (std::size_t i = 0; i < samples_.rows.size(); ++i)
      kept[static_cast<std::size_t>(fold_of(i))](samples_.rows[i]) = 0.0;
    const std::vector<MatrixXd> sums = equations(kept, W);
    MatrixXd all(samples_.count(), n_);
    VectorXd nats = VectorXd::Zero(samples_.parts.count);
    for (Index fold = 0; fold < folds; ++fold) {
      const MatrixXd e = errors(stepped(step_of(sums[static_cast<std::size_t>(fold)])), weight, W);
      for (std::size_t i = 0; i < samples_.rows.size(); ++i)
        if (fold_of(i) == fold) all.row(static_cast<Index>(i)) = e.col(samples_.rows[i]).transpose();
      for (const Stretch& stretch : stretches_)
        if (fold_of(stretch.first_row) == fold) nats(samples_.parts.part[stretch.first_row]) += stretch.nats;
    }
    constexpr double huge = 1e100;  // errors that grew without bound
    all = all.array().isFinite().select(all, huge);
    LeftOutForecast forecast = left_out_forecast(all, samples_.parts, VectorXd::Zero(n_));
    forecast.of_part -= nats.array().isFinite().select(nats, huge).matrix();
    forecast.log_score = forecast.of_part.sum() / static_cast<double>(samples_.count());
    return forecast;
  }

  MatrixXd stepped(const VectorXd& step) const { return bounded(all_ + step.reshaped(all_.cols(), n_).transpose()); }

  /// Shrinks roots of C to .995 where they are larger.
  MatrixXd bounded(MatrixXd all) const {
    constexpr double most_root = 0.995;
    if (nc_ == 0) return all;
    auto C = all.rightCols(n_ * nc_);
    const VectorXd increments = (-C - MatrixXd::Identity(n_, C.cols())).reshaped<Eigen::RowMajor>();
    const double radius = spectral_radius(unpack({.states = n_, .state_lags = nc_}, increments));
    const double shrunk = std::min(1.0, most_root / radius);
    for (Index lag = 1; lag <= nc_; ++lag)
      C.middleCols((lag - 1) * n_, n_) *= std::pow(shrunk, static_cast<double>(lag));
    return all;
  }

  /// z of C(q) z = r at sample k in place, n columns a sample.
  static void divide(const MatrixXd& C, Index k, MatrixXd& r) {
    const Index n = C.rows();
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < C.cols(); ++j) r.col(k * n + i) -= C(i, j) * r.col((k - 1 - j / n) * n + j % n);
  }
  /// n columns a sample, times W and the root of the sample's weight.
  MatrixXd whitened(MatrixXd of, const VectorXd& weight, const MatrixXd& W) const {
    const auto component = [&](Index i) { return of(Eigen::all, Eigen::seqN(i, weight.size(), n_)); };
    for (Index i = n_ - 1; i >= 0; --i) {
      MatrixXd sum = W(i, i) * component(i);
      for (Index j = 0; j < i; ++j) sum += W(i, j) * component(j);
      component(i) = sum * weight.cwiseSqrt().asDiagonal();
    }
    return of;
  }

  /// Errors of the rows and of the samples before each stretch, which replace the lagged residuals among the
  /// regressors; zero elsewhere.
  MatrixXd errors(const MatrixXd& all, const VectorXd& weight, const MatrixXd& W) {
    const Index s = n_ * nc_, P = all.cols() - s;
    const MatrixXd C = all.rightCols(s), equation = samples_.y - all.leftCols(P) * X_.topRows(P);
    MatrixXd e = MatrixXd::Zero(1, n_ * X_.cols());
    for (const Index k : samples_.rows) {
      e.middleCols(k * n_, n_) = equation.col(k).transpose();
      divide(C, k, e);
    }
    if (s > 0) estimate_starts(C, weight, W, e);
    const MatrixXd found = e.reshaped(n_, X_.cols());
    for (Index j = 1; j <= nc_; ++j)
      X_.middleRows(P + (j - 1) * n_, n_).rightCols(X_.cols() - j) = found.leftCols(X_.cols() - j);
    return found;
  }
  void estimate_starts(const MatrixXd& C, const VectorXd& weight, const MatrixXd& W, MatrixXd& e) {
    constexpr double faded = 1e-9;
    const Index s = C.cols();
    Index end = s;
    by_start_.setIdentity(s, s + n_ * std::ranges::max(stretches_, {}, &Stretch::count).count);
    for (; end < by_start_.cols() && by_start_.middleCols(end - s, s).cwiseAbs().maxCoeff() > faded; end += n_)
      divide(C, end / n_, by_start_);
    by_start_.conservativeResize(s, end);
    for (Stretch& stretch : stretches_) {
      const MatrixXd G = by_start_of(stretch, weight, W), information = G * G.transpose();
      auto block = e.middleCols(n_ * (stretch.first - nc_), G.cols());
      const VectorXd white = whitened(block, weight.segment(stretch.first - nc_, G.cols() / n_), W).transpose();
      const VectorXd start = -Cholesky(information).solve(G * white);
      block += start.transpose() * by_start_.leftCols(G.cols());
      stretch.nats = 0.5 * ((W * start.reshaped(n_, nc_)).squaredNorm() + log_determinant(information)) -
                     static_cast<double>(nc_) * W.diagonal().array().log().sum();
    }
  }
  MatrixXd by_start_of(const Stretch& stretch, const VectorXd& weight, const MatrixXd& W) const {
    const Index samples = std::min(nc_ + stretch.count, by_start_.cols() / n_);
    return whitened(by_start_.leftCols(n_ * samples), weight.segment(stretch.first - nc_, samples), W);
  }

  /// Huber's weights of rows, one before stretches and zero elsewhere. They are one unless a standard deviation exceeds
  /// the scale by the median by more than a fifth: rounding and Gaussian tails must not cost efficiency.
  VectorXd weights() const {
    constexpr double most_ratio = 1.2;
    double most = 1.0;
    VectorXd size = VectorXd::Constant(samples_.count(), huber_tuning), result = VectorXd::Zero(errors_.cols());
    for (Index i = 0; i < n_; ++i) {
      const VectorXd e = errors_(i, samples_.rows).transpose().cwiseAbs();
      const double sd = std::sqrt(e.squaredNorm() / static_cast<double>(e.size())) + 1e-100;
      const double scale = std::max(0.1 * sd, mad_to_sd * median(e));
      most = std::max(most, sd / scale);
      size = size.cwiseMax(e / scale);
    }
    result(samples_.rows) = most < most_ratio ? VectorXd::Ones(size.size()) : VectorXd(huber_tuning / size.array());
    for (const Stretch& stretch : stretches_) result.segment(stretch.first - nc_, nc_).setOnes();
    return result;
  }

  /// Normal equations [J; e] [J; e]' for several weights of samples. J: derivatives of -e by the rows of [theta C], one
  /// after the other; n columns a sample.
  std::vector<MatrixXd> equations(const std::vector<VectorXd>& weights, const MatrixXd& W) const {
    const Index q = X_.rows(), p = n_ * q;
    const MatrixXd C = all_.rightCols(n_ * nc_);
    std::vector<MatrixXd> sums(weights.size(), MatrixXd::Zero(p + 1, p + 1));
    for (const Stretch& stretch : stretches_) {
      MatrixXd J = MatrixXd::Zero(p + 1, n_ * (nc_ + stretch.count));
      for (Index k = nc_; k < nc_ + stretch.count; ++k) {
        for (Index i = 0; i < n_; ++i) J.col(k * n_ + i).segment(i * q, q) = X_.col(stretch.first - nc_ + k);
        divide(C, k, J);
      }
      J.bottomRows(1) = errors_.middleCols(stretch.first - nc_, nc_ + stretch.count).reshaped().transpose();
      for (std::size_t i = 0; i < weights.size(); ++i) add(stretch, J, weights[i], W, sums[i]);
    }
    return sums;
  }
  /// Without errors before the stretch: at their estimate they leave J e as it is.
  void add(const Stretch& stretch, const MatrixXd& J, const VectorXd& weight, const MatrixXd& W, MatrixXd& sum) const {
    const MatrixXd white = whitened(J, weight.segment(stretch.first - nc_, nc_ + stretch.count), W);
    sum.selfadjointView<Eigen::Lower>().rankUpdate(white);
    if (nc_ == 0) return;
    const MatrixXd G = by_start_of(stretch, weight, W), cross = G * white.leftCols(G.cols()).transpose();
    const MatrixXd lost = Cholesky(G * G.transpose()).whiten(cross);
    sum.selfadjointView<Eigen::Lower>().rankUpdate(lost.transpose(), -1.0);
  }
  static MatrixXd left_side(const MatrixXd& sum) {
    return sum.topLeftCorner(sum.rows() - 1, sum.rows() - 1).selfadjointView<Eigen::Lower>();
  }
  static VectorXd step_of(const MatrixXd& sum) {
    return solve(left_side(sum), sum.bottomRows(1).leftCols(sum.rows() - 1).transpose());
  }

  /// At most 15 steps with halving. Weights and the covariance are those at the begin of a step.
  void descend() {
    constexpr int most_steps = 15;
    constexpr double tolerance = 1e-9;  // of log det
    errors_ = errors(all_, weights(), MatrixXd::Identity(n_, n_));
    double gained = 1.0;
    for (int steps = 0; steps < most_steps && gained > tolerance; ++steps) {
      const VectorXd weight = weights();
      const MatrixXd W = whitening(covariance(errors_, weight));
      errors_ = errors(all_, weight, W);
      const double value = log_determinant(covariance(errors_, weight));
      const VectorXd step = step_of(equations({weight}, W).front());
      gained = 0.0;
      for (double h = 1.0; h > 1e-3 && !(gained > 0.0); h /= 2.0) {
        const MatrixXd next = stepped(h * step), e = errors(next, weight, W);
        gained = value - log_determinant(covariance(e, weight));
        if (!(gained > 0.0)) continue;
        all_ = next;
        errors_ = e;
      }
    }
  }
};

}  // namespace

void add_residuals(ArmaxSamples& samples, const std::vector<Index>& least_delay) {
  // Few rows get fewer lags: residuals of a fit that has as many parameters as rows would be zero.
  const auto most = static_cast<double>(20 * samples.y.rows() + 30 * samples.u.rows() + 1);
  const double share = std::min(1.0, static_cast<double>(samples.count()) / most / 4.0);
  const auto lags = [&](double all) { return std::max<Index>(4, static_cast<Index>(all * share)); };
  const MatrixXd X = regressors(samples, {{samples.differences, lags(20.0), lags(30.0), 0}, least_delay});
  samples.residuals.setZero(samples.y.rows(), samples.y.cols());
  samples.residuals(Eigen::all, samples.long_rows) =
      (samples.y - regression(samples, X, samples.long_rows) * X)(Eigen::all, samples.long_rows);
}

MatrixXd least_squares_covariance(const ArmaxSamples& samples, const ArmaxStructure& structure) {
  const MatrixXd X = regressors(samples, structure);
  const MatrixXd e = (samples.y - regression(samples, X, samples.rows) * X)(Eigen::all, samples.rows);
  return e * e.transpose() / static_cast<double>(samples.count());
}

ArmaxFit fit_armax(const ArmaxSamples& samples, const ArmaxStructure& structure, bool leave_out) {
  return Fitter(samples, structure).fit(leave_out);
}

}  // namespace modebank
