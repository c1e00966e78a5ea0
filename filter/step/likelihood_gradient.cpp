#include "filter/step/likelihood_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/step/imm.hpp"
#include "filter/step/samples.hpp"

namespace modebank {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

template <class Matrix>
auto symmetric_part(const Matrix& M) {
  return (0.5 * (M + M.transpose())).eval();
}

/// Stores every step of a stretch. A stretch that is not the last is filtered again before the way back over it.
template <int N, int NY>
class ReversePass {
  using StateVector = Eigen::Matrix<double, N, 1>;
  using StateMatrix = Eigen::Matrix<double, N, N>;
  using SignalMatrix = Eigen::Matrix<double, NY, NY>;
  static constexpr int moments = N == Eigen::Dynamic ? Eigen::Dynamic : N + N * N;

 public:
  ReversePass(const Bank& bank, const Trajectory& run, const FilterOptions& options)
      : run_(run),
        instants_(bank, run),
        filters_(static_cast<std::size_t>(std::clamp<Index>(instants_.count(), 1, longest_stretch(bank))),
                 ImmFilter<N, NY>(bank, options)),
        model_(filters_.front().model()),
        none_{{bank.modes.size(), Gaussian<N>(bank.structure.dimension())}, VectorXd::Zero(bank.mode_count())},
        by_(none_),
        by_before_(none_),
        by_weight_(bank.mode_count(), bank.mode_count()) {
    const Index n = bank.structure.dimension(), K = bank.mode_count();
    moments_.resize(K, n + n * n);
    by_moments_.resize(n + n * n, K);
    by_moments_before_.resize(n + n * n, K);
    const MatrixXd zero = MatrixXd::Zero(n, n);
    const LinearModel none{zero, MatrixXd::Zero(n, bank.structure.acting_inputs()), VectorXd::Zero(n)};
    sum_ = {0.0, {bank.modes.size(), {none, zero}}, 0.0 * bank.R, MatrixXd::Zero(K, K), zero};
  }

  BankGradient go_back() {
    const Index stretches = (instants_.count() + length() - 1) / length();
    for (Index s = 0; s < stretches; ++s) {
      kept_.push_back(filters_.back().state());
      sum_.log_likelihood = follow_stretch(s, sum_.log_likelihood);
    }
    for (Index s = stretches; s-- > 0;) {
      if (s + 1 < stretches) follow_stretch(s, 0.0);
      for (Index t = end_of(s); t-- > s * length();) back_over(t);
    }
    return std::move(sum_);
  }

 private:
  const Trajectory& run_;
  RunInstants instants_;
  std::vector<ImmFilter<N, NY>> filters_;  ///< after each moment of a stretch
  const FilterModel<N, NY>& model_;
  std::vector<FilterState<N>> kept_;  ///< before each stretch
  FilterState<N> none_;               ///< no derivative
  FilterState<N> by_, by_before_;  ///< derivatives of all later moments with respect to the estimates and probabilities
  VectorXd by_prior_;              ///< derivatives with respect to the mode probabilities before the measurement
  MatrixXd by_weight_;             ///< K x K
  Eigen::Matrix<double, Eigen::Dynamic, moments> moments_;  ///< of the modes before the mixing, K x (n + n^2)
  Eigen::Matrix<double, moments, Eigen::Dynamic> by_moments_, by_moments_before_;
  BankGradient sum_;

  /// The steps of a stretch stay in the processor's cache.
  static Index longest_stretch(const Bank& bank) {
    const Index n = bank.structure.dimension(), K = bank.mode_count();
    return std::max<Index>(16, 20'000 / (K * (8 * n * n + K + 32)));
  }
  Index length() const { return std::ssize(filters_); }
  Index end_of(Index stretch) const { return std::min((stretch + 1) * length(), instants_.count()); }
  const ImmFilter<N, NY>& after(Index t) const { return filters_[t % length()]; }
  const FilterState<N>& before(Index t) const { return t % length() == 0 ? kept_[t / length()] : after(t - 1).state(); }

  /// Filters a stretch of moments. Returns the log-likelihood from `sum` on.
  double follow_stretch(Index stretch, double sum) {
    for (Index t = stretch * length(); t < end_of(stretch); ++t) {
      ImmFilter<N, NY>& filter = filters_[t % length()];
      filter.start(before(t));
      const double log_density = follow(instants_, t, run_, filter);
      if (!std::isnan(log_density)) sum += log_density;
    }
    return sum;
  }

  /// Goes back over moment t of the run.
  void back_over(Index t) {
    const Instant& instant = instants_.instants[t];
    if (instant.starts) {  // the mean at the start is the measurement itself
      for (const Gaussian<N>& mode : by_.modes) sum_.start_covariance += mode.covariance;
      by_ = none_;
      return;
    }
    by_prior_ = by_.mode_probability;
    if (instant.sample >= 0 && missing_entries(run_.state.col(instant.sample)) < run_.state.rows())
      back_over_measurement(after(t), run_.state.col(instant.sample));
    for (std::size_t j = 0; j < by_.modes.size(); ++j) back_over_motion(j, after(t).mixed(j), instants_.inputs.col(t));
    if (by_.modes.size() > 1) back_over_mixing(after(t), before(t));
  }

  /// Goes back over Bayes' rule and the update of every mode. Converts derivatives with respect to the estimates into
  /// derivatives with respect to the predictions.
  template <class Y>
  void back_over_measurement(const ImmFilter<N, NY>& filter, const Y& y) {
    const VectorXd &posterior = filter.mode_probability(), &prior = filter.predicted_probability();
    const VectorXd by_log =
        posterior.array() * (1.0 + by_.mode_probability.array() - by_.mode_probability.dot(posterior));
    by_prior_ = (prior.array() >= impossible_probability).select(by_log.cwiseQuotient(prior), 0.0);
    SignalMatrix by_R = SignalMatrix::Zero(y.size(), y.size());
    for (Index j = 0; j < prior.size(); ++j)
      by_R += back_over_update(filter.sensor().C, filter.kalman(j), by_log(j), by_.modes[j]);
    for (Index i = 0; i < y.size(); ++i)  // R of a missing signal is not a parameter of the bank
      if (is_missing(y(i))) {
        by_R.row(i).setZero();
        by_R.col(i).setZero();
      }
    sum_.R += by_R;
  }

  /// Goes back over m = x + K e, P' = (I - K C) P with K = P C' S^-1 and S = C P C' + R, and over log N(e; 0, S).
  /// Returns the derivative with respect to R.
  static SignalMatrix back_over_update(const Eigen::Matrix<double, NY, N>& C, const KalmanStep<N, NY>& kalman,
                                       double by_density, Gaussian<N>& by) {
    SignalMatrix inverse = SignalMatrix::Identity(C.rows(), C.rows());
    for (Index i = 0; i < C.rows(); ++i) kalman.cholesky.solve(inverse.col(i));
    const Eigen::Matrix<double, N, NY> gain = kalman.predicted.covariance * C.transpose() * inverse;
    const StateMatrix kept = StateMatrix::Identity(C.cols(), C.cols()) - gain * C;
    const Eigen::Matrix<double, NY, 1> scaled = inverse * kalman.innovation;
    const StateVector back = C.transpose() * scaled, through = kept.transpose() * by.mean;
    const SignalMatrix by_S = 0.5 * by_density * (scaled * scaled.transpose() - inverse);
    const SignalMatrix by_R = by_S + gain.transpose() * by.covariance * gain -
                              symmetric_part((gain.transpose() * by.mean * scaled.transpose()).eval());
    by.covariance = (kept.transpose() * by.covariance * kept + symmetric_part((through * back.transpose()).eval()) +
                     C.transpose() * by_S * C)
                        .eval();
    by.mean = through + by_density * back;
    return by_R;
  }

  /// Goes back over x = F m + B u + c and P' = F P F' + Q.
  template <class U>
  void back_over_motion(std::size_t j, const Gaussian<N>& from, const U& u) {
    const StateMatrix& F = model_.modes[j].F;
    Gaussian<N>& by = by_.modes[j];
    BankGradient::Mode& sum = sum_.modes[j];
    sum.model.A += by.mean * from.mean.transpose() + 2.0 * by.covariance * F * from.covariance;
    sum.model.B += by.mean * u.transpose();
    sum.model.c += by.mean;
    sum.Q += by.covariance;
    by.mean = (F.transpose() * by.mean).eval();
    by.covariance = (F.transpose() * by.covariance * F).eval();
  }

  /// Goes back over the mixing. Every mode starts from the mixture of all modes with weights W_ij = T_ij mu_i / c_j.
  /// Its mean M_j and second moment S_j about any point r, which the result does not depend on, are linear in W and in
  /// the moments d_i = m_i - r and P_i + d_i d_i' of the modes before; its covariance is S_j - M_j M_j'.
  void back_over_mixing(const ImmFilter<N, NY>& filter, const FilterState<N>& before) {
    const Index K = model_.bank.mode_count(), n = model_.bank.structure.dimension();
    StateVector r = StateVector::Zero(n);  // near the means, so that their differences keep their digits
    for (Index i = 0; i < K; ++i) r += before.mode_probability(i) * before.modes[i].mean;
    for (Index j = 0; j < K; ++j) {
      const Gaussian<N>&from = before.modes[j], &to = by_.modes[j];
      const StateVector d = from.mean - r;
      moments_.row(j) << d.transpose(), (from.covariance + d * d.transpose()).reshaped().transpose();
      by_moments_.col(j) << to.mean - 2.0 * to.covariance * (filter.mixed(j).mean - r), to.covariance.reshaped();
    }
    by_weight_.noalias() = moments_.lazyProduct(by_moments_);
    by_moments_before_.noalias() = by_moments_.lazyProduct(filter.mixing().transpose());
    by_before_.mode_probability.setZero();
    for (Index i = 0; i < K; ++i) {
      Gaussian<N>& by = by_before_.modes[i];
      by.covariance = by_moments_before_.col(i).tail(n * n).reshaped(n, n);
      by.mean = by_moments_before_.col(i).head(n) + 2.0 * by.covariance * moments_.row(i).head(n).transpose();
    }
    const VectorXd& prior = filter.predicted_probability();
    for (Index j = 0; j < K; ++j) {
      if (prior(j) < impossible_probability) continue;
      const double mean_by_weight = by_weight_.col(j).dot(filter.mixing().col(j));
      const auto by_pair = ((by_weight_.col(j).array() - mean_by_weight) / prior(j) + by_prior_(j)).matrix();
      sum_.transition.col(j) += by_pair.cwiseProduct(before.mode_probability);
      by_before_.mode_probability += by_pair.cwiseProduct(model_.bank.transition.matrix().col(j));
    }
    std::swap(by_, by_before_);
  }
};

}  // namespace

BankGradient& BankGradient::operator+=(const BankGradient& other) {
  log_likelihood += other.log_likelihood;
  for (std::size_t j = 0; j < modes.size(); ++j) {
    modes[j].model.A += other.modes[j].model.A;
    modes[j].model.B += other.modes[j].model.B;
    modes[j].model.c += other.modes[j].model.c;
    modes[j].Q += other.modes[j].Q;
  }
  R += other.R;
  transition += other.transition;
  start_covariance += other.start_covariance;
  return *this;
}

double BankGradient::along(const Bank& from, const Bank& to) const {
  const auto change = [](const MatrixXd& by, const auto& a, const auto& b) { return by.cwiseProduct(b - a).sum(); };
  double sum = change(R, from.R, to.R) + change(transition, from.transition.matrix(), to.transition.matrix()) +
               change(start_covariance, start_moments(from).covariance, start_moments(to).covariance);
  for (std::size_t j = 0; j < modes.size(); ++j) {
    const modebank::Mode &a = from.modes[j], &b = to.modes[j];
    sum += change(modes[j].model.A, a.model.A, b.model.A) + change(modes[j].model.B, a.model.B, b.model.B) +
           change(modes[j].model.c, a.model.c, b.model.c) + change(modes[j].Q, a.Q, b.Q);
  }
  return sum;
}

bool has_likelihood_gradient(const Bank& bank, const FilterOptions& options) {
  return (options.variant == FilterVariant::imm || (options.variant == FilterVariant::kf && bank.mode_count() == 1)) &&
         bank.transition_logit.empty() && bank.terms.empty();
}

BankGradient log_likelihood_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() { return ReversePass<N, NY>(bank, run, options).go_back(); });
}

}  // namespace modebank
