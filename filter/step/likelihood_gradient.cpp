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
  using Gain = Eigen::Matrix<double, N, NY>;
  static constexpr int moments = N == Eigen::Dynamic ? Eigen::Dynamic : N + N * N;

 public:
  ReversePass(const Bank& bank, const Trajectory& run, const FilterOptions& options)
      : run_(run),
        model_(bank, options),
        instants_(bank, run),
        after_(initial_state(model_)),
        stretch_length_(std::min(stretch_length(bank), instants_.count())),
        before_(static_cast<std::size_t>(stretch_length_), after_),
        steps_(static_cast<std::size_t>(stretch_length_), FilterStep<N, NY>(model_)),
        none_{{after_.modes.size(), Gaussian<N>(bank.structure.dimension())}, VectorXd::Zero(bank.mode_count())},
        by_(none_),
        by_before_(none_),
        by_weight_(bank.mode_count(), bank.mode_count()) {
    const Index n = bank.structure.dimension(), K = bank.mode_count();
    moments_.resize(K, n + n * n);
    by_moments_.resize(n + n * n, K);
    by_moments_before_.resize(n + n * n, K);
    for (const Mode& mode : bank.modes)
      sum_.modes.push_back(
          {{MatrixXd::Zero(n, n), MatrixXd::Zero(n, mode.model.B.cols()), VectorXd::Zero(n)}, MatrixXd::Zero(n, n)});
    sum_.R = MatrixXd::Zero(bank.R.rows(), bank.R.cols());
    sum_.transition = MatrixXd::Zero(K, K);
    sum_.start_covariance = MatrixXd::Zero(n, n);
  }

  BankGradient go_back() {
    std::vector<FilterState<N>> kept;  // state before each stretch of moments
    for (Index first = 0; first < instants_.count(); first += stretch_length_) {
      kept.push_back(after_);
      sum_.log_likelihood = follow_stretch(first, sum_.log_likelihood);
    }
    for (Index s = std::ssize(kept); s-- > 0;) {
      const Index first = s * stretch_length_, end = std::min(first + stretch_length_, instants_.count());
      if (end < instants_.count()) {
        after_ = kept[static_cast<std::size_t>(s)];
        follow_stretch(first);
      }
      for (Index t = end; t-- > first;) back_over(t, static_cast<std::size_t>(t - first));
    }
    return std::move(sum_);
  }

 private:
  const Trajectory& run_;
  FilterModel<N, NY> model_;
  RunInstants instants_;
  FilterState<N> after_;  ///< after the present moment
  Index stretch_length_;
  std::vector<FilterState<N>> before_;    ///< before each moment of a stretch
  std::vector<FilterStep<N, NY>> steps_;  ///< to each moment of a stretch
  FilterState<N> none_;                   ///< no derivative
  FilterState<N> by_, by_before_;  ///< derivatives of all later moments with respect to the estimates and probabilities
  VectorXd by_prior_;              ///< derivatives with respect to the mode probabilities before the measurement
  MatrixXd by_weight_;             ///< K x K
  Eigen::Matrix<double, Eigen::Dynamic, moments> moments_;  ///< of the modes before the mixing, K x (n + n^2)
  Eigen::Matrix<double, moments, Eigen::Dynamic> by_moments_, by_moments_before_;
  BankGradient sum_;

  /// The steps of a stretch stay in the processor's cache.
  static Index stretch_length(const Bank& bank) {
    const Index n = bank.structure.dimension(), K = bank.mode_count();
    return std::max<Index>(16, 20'000 / (K * (8 * n * n + K + 32)));
  }

  /// Filters a stretch of moments from `after_` on. Returns the log-likelihood from `sum` on.
  double follow_stretch(Index first, double sum = 0.0) {
    for (Index t = first; t < std::min(first + stretch_length_, instants_.count()); ++t) {
      const Instant& instant = instants_.instants[static_cast<std::size_t>(t)];
      before_[static_cast<std::size_t>(t - first)] = after_;
      FilterStep<N, NY>& step = steps_[static_cast<std::size_t>(t - first)];
      if (instant.starts) {
        start(model_, instant.start, after_);
        continue;
      }
      predict(model_, after_, instants_.inputs.col(t), step);
      if (instant.sample < 0) {
        skip_measurement(step, after_);
      } else if (const double log_density = update(model_, run_.state.col(instant.sample), step, after_);
                 !std::isnan(log_density)) {
        sum += log_density;
      }
    }
    return sum;
  }

  /// Goes back over moment t of the run, which is `at` in its stretch.
  void back_over(Index t, std::size_t at) {
    const Instant& instant = instants_.instants[static_cast<std::size_t>(t)];
    const FilterState<N>& before = before_[at];
    const FilterStep<N, NY>& step = steps_[at];
    if (instant.starts) {  // the mean at the start is the measurement itself
      for (const Gaussian<N>& mode : by_.modes) sum_.start_covariance += mode.covariance;
      by_ = none_;
    } else {
      by_prior_ = by_.mode_probability;
      if (instant.sample >= 0 && step.partial.missing < run_.state.rows())
        back_over_measurement(step, run_.state.col(instant.sample));
      const bool one = model_.mode_count() == 1;
      for (std::size_t j = 0; j < by_.modes.size(); ++j)
        back_over_motion(j, one ? before.modes[0] : step.mixed[j], instants_.inputs.col(t));
      if (!one) back_over_mixing(step, before);
    }
    after_ = before;
  }

  /// Goes back over Bayes' rule and the update of every mode. Converts derivatives with respect to the estimates into
  /// derivatives with respect to the predictions.
  template <class Y>
  void back_over_measurement(const FilterStep<N, NY>& step, const Y& y) {
    const VectorXd& posterior = after_.mode_probability;
    const VectorXd by_log =
        posterior.array() * (1.0 + by_.mode_probability.array() - by_.mode_probability.dot(posterior));
    by_prior_ = (step.predicted_probability.array() >= impossible_probability)
                    .select(by_log.cwiseQuotient(step.predicted_probability), 0.0);
    SignalMatrix by_R = SignalMatrix::Zero(y.size(), y.size());
    for (std::size_t j = 0; j < by_.modes.size(); ++j)
      by_R += back_over_update(step.partial.missing > 0 ? step.partial.C : model_.C, step.kalman[j],
                               by_log(static_cast<Index>(j)), by_.modes[j]);
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
    const Gain gain = kalman.predicted.covariance * C.transpose() * inverse;
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
  void back_over_mixing(const FilterStep<N, NY>& step, const FilterState<N>& before) {
    const Index K = model_.mode_count(), n = model_.structure.dimension();
    StateVector r(n);
    combine_means(before, r);  // near the means, so that their differences keep their digits
    for (Index j = 0; j < K; ++j) {
      const Gaussian<N>& from = before.modes[static_cast<std::size_t>(j)];
      const Gaussian<N>& to = by_.modes[static_cast<std::size_t>(j)];
      const StateVector d = from.mean - r;
      moments_.row(j) << d.transpose(), (from.covariance + d * d.transpose()).reshaped().transpose();
      by_moments_.col(j) << to.mean - 2.0 * to.covariance * (step.mixed[static_cast<std::size_t>(j)].mean - r),
          to.covariance.reshaped();
    }
    by_weight_.noalias() = moments_.lazyProduct(by_moments_);
    by_moments_before_.noalias() = by_moments_.lazyProduct(step.mixing.transpose());
    by_before_.mode_probability.setZero();
    for (Index i = 0; i < K; ++i) {
      Gaussian<N>& by = by_before_.modes[static_cast<std::size_t>(i)];
      by.covariance = by_moments_before_.col(i).tail(n * n).reshaped(n, n);
      by.mean = by_moments_before_.col(i).head(n) + 2.0 * by.covariance * moments_.row(i).head(n).transpose();
    }
    const VectorXd& prior = step.predicted_probability;
    for (Index j = 0; j < K; ++j) {
      if (prior(j) < impossible_probability) continue;
      const double mean_by_weight = by_weight_.col(j).dot(step.mixing.col(j));
      const auto by_pair = ((by_weight_.col(j).array() - mean_by_weight) / prior(j) + by_prior_(j)).matrix();
      sum_.transition.col(j) += by_pair.cwiseProduct(before.mode_probability);
      by_before_.mode_probability += by_pair.cwiseProduct(model_.transition.matrix().col(j));
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
         bank.transition_logit.empty() && bank.terms.empty() && bank.noise_factor.empty();
}

BankGradient log_likelihood_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() { return ReversePass<N, NY>(bank, run, options).go_back(); });
}

}  // namespace modebank
