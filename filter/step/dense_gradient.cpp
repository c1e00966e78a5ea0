#include "filter/step/dense_gradient.hpp"

#include <algorithm>
#include <vector>

#include "filter/step/equations/filter_step.hpp"
#include "filter/step/feed/run_samples.hpp"

namespace modebank {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
constexpr int any = Eigen::Dynamic;

MatrixXd symmetric_part(const MatrixXd& M) { return 0.5 * (M + M.transpose()); }

/// Derivatives with respect to the estimate of one mode.
struct ByGaussian {
  VectorXd mean;
  MatrixXd covariance;
};

/// Derivatives with respect to the filter's state.
struct ByState {
  std::vector<ByGaussian> modes;
  VectorXd probability;

  ByState(Index n, Index K)
      : modes(static_cast<std::size_t>(K), {VectorXd::Zero(n), MatrixXd::Zero(n, n)}), probability(VectorXd::Zero(K)) {}
};

class DenseGradient {
 public:
  DenseGradient(const Bank& bank, const Trajectory& run, const FilterOptions& options)
      : run_(run),
        model_(bank, options),
        instants_(bank, run),
        step_(model_),
        by_(bank.structure.dimension(), bank.mode_count()) {
    const Index n = bank.structure.dimension(), K = bank.mode_count();
    for (const Mode& mode : bank.modes)
      sum_.modes.push_back(
          {{MatrixXd::Zero(n, n), MatrixXd::Zero(n, mode.model.B.cols()), VectorXd::Zero(n)}, MatrixXd::Zero(n, n)});
    sum_.R = MatrixXd::Zero(bank.R.rows(), bank.R.cols());
    sum_.transition = MatrixXd::Zero(K, K);
    sum_.start_covariance = MatrixXd::Zero(n, n);
  }

  BankGradient go_back() {
    std::vector<FilterState<any>> kept;  // state before each stretch of moments
    std::vector<FilterState<any>> before;
    FilterState<any> state = initial_state(model_);
    for (Index first = 0; first < instants_.count(); first += stretch_length) {
      kept.push_back(state);
      before = follow_stretch(first, state);
    }
    for (Index s = std::ssize(kept); s-- > 0;) {
      if (s + 1 < std::ssize(kept)) before = follow_stretch(s * stretch_length, kept[static_cast<std::size_t>(s)]);
      for (Index t = std::ssize(before); t-- > 0;)
        back_over(s * stretch_length + t, before[static_cast<std::size_t>(t)]);
    }
    return std::move(sum_);
  }

 private:
  static constexpr Index stretch_length = 100;
  const Trajectory& run_;
  FilterModel<any, any> model_;
  RunInstants instants_;
  FilterStep<any, any> step_;
  ByState by_;         ///< derivatives with respect to the state, of all later moments
  VectorXd by_prior_;  ///< derivatives with respect to the mode probabilities before the measurement
  BankGradient sum_;

  /// Filters a stretch of moments. Returns the state before each moment.
  std::vector<FilterState<any>> follow_stretch(Index first, FilterState<any>& state) {
    std::vector<FilterState<any>> before;
    for (Index t = first; t < std::min(first + stretch_length, instants_.count()); ++t) {
      before.push_back(state);
      step_to(model_, instants_, t, run_, state, step_);
    }
    return before;
  }

  void back_over(Index t, const FilterState<any>& before) {
    const Instant& instant = instants_.instants[static_cast<std::size_t>(t)];
    const Index n = sum_.start_covariance.rows(), K = model_.mode_count();
    if (instant.starts) {  // the mean at the start is the measurement itself
      for (const ByGaussian& mode : by_.modes) sum_.start_covariance += mode.covariance;
      by_ = ByState(n, K);
      return;
    }
    FilterState<any> state = before;
    by_prior_ = by_.probability;
    if (step_to(model_, instants_, t, run_, state, step_))
      back_over_measurement(run_.state.col(instant.sample), state.mode_probability);
    for (std::size_t j = 0; j < by_.modes.size(); ++j)
      back_over_motion(j, K == 1 ? before.modes[0] : step_.mixed[j], instants_.inputs.col(t));
    if (K > 1) back_over_mixing(before);
  }

  /// Goes back over Bayes' rule and the update of every mode. Converts derivatives with respect to the estimates into
  /// derivatives with respect to the predictions.
  template <class Y>
  void back_over_measurement(const Y& y, const VectorXd& posterior) {
    const VectorXd by_log = posterior.array() * (1.0 + by_.probability.array() - by_.probability.dot(posterior));
    by_prior_ = (step_.predicted_probability.array() >= impossible_probability)
                    .select(by_log.cwiseQuotient(step_.predicted_probability), 0.0);
    MatrixXd by_R = MatrixXd::Zero(y.size(), y.size());
    for (std::size_t j = 0; j < by_.modes.size(); ++j)
      by_R += back_over_update(step_.partial.missing > 0 ? step_.partial.C : model_.C, step_.kalman[j],
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
  static MatrixXd back_over_update(const MatrixXd& C, const KalmanStep<any, any>& kalman, double by_density,
                                   ByGaussian& by) {
    MatrixXd inverse = MatrixXd::Identity(C.rows(), C.rows());
    for (Index i = 0; i < C.rows(); ++i) kalman.cholesky.solve(inverse.col(i));
    const MatrixXd gain = kalman.predicted.covariance * C.transpose() * inverse;
    const MatrixXd kept = MatrixXd::Identity(C.cols(), C.cols()) - gain * C;
    const VectorXd scaled = inverse * kalman.innovation, back = C.transpose() * scaled;
    const VectorXd through = kept.transpose() * by.mean;
    const MatrixXd by_S = 0.5 * by_density * (scaled * scaled.transpose() - inverse);
    MatrixXd by_R = by_S + gain.transpose() * by.covariance * gain -
                    symmetric_part(gain.transpose() * by.mean * scaled.transpose());
    by.covariance = (kept.transpose() * by.covariance * kept + symmetric_part(through * back.transpose()) +
                     C.transpose() * by_S * C)
                        .eval();
    by.mean = through + by_density * back;
    return by_R;
  }

  /// Goes back over x = F m + B u + c and P' = F P F' + Q.
  template <class U>
  void back_over_motion(std::size_t j, const Gaussian<any>& from, const U& u) {
    const MatrixXd& F = model_.modes[j].F;
    ByGaussian& by = by_.modes[j];
    BankGradient::Mode& sum = sum_.modes[j];
    sum.model.A += by.mean * from.mean.transpose() + 2.0 * by.covariance * F * from.covariance;
    sum.model.B += by.mean * u.transpose();
    sum.model.c += by.mean;
    sum.Q += by.covariance;
    by.mean = (F.transpose() * by.mean).eval();
    by.covariance = (F.transpose() * by.covariance * F).eval();
  }

  /// Goes back over the mixing. Every mode starts from the mixture of all modes with weights W_ij = T_ij mu_i / c_j.
  /// (The derivative of the mixture's covariance with respect to its mean is zero.)
  void back_over_mixing(const FilterState<any>& before) {
    const Index n = sum_.start_covariance.rows(), K = model_.mode_count();
    ByState by(n, K);
    MatrixXd by_weight(K, K);
    for (Index j = 0; j < K; ++j)
      for (Index i = 0; i < K; ++i) {
        const Gaussian<any>& from = before.modes[static_cast<std::size_t>(i)];
        const ByGaussian& to = by_.modes[static_cast<std::size_t>(j)];
        const VectorXd off = from.mean - step_.mixed[static_cast<std::size_t>(j)].mean,
                       gradient_of_mean = to.covariance * off;
        const double weight = step_.mixing.matrix(i, j);
        ByGaussian& sum = by.modes[static_cast<std::size_t>(i)];
        sum.mean += weight * (to.mean + 2.0 * gradient_of_mean);
        sum.covariance += weight * to.covariance;
        by_weight(i, j) =
            to.mean.dot(from.mean) + to.covariance.cwiseProduct(from.covariance).sum() + off.dot(gradient_of_mean);
      }
    const VectorXd mean_by_weight = by_weight.cwiseProduct(step_.mixing.matrix).colwise().sum();
    const VectorXd& prior = step_.predicted_probability;
    for (Index j = 0; j < K; ++j) {
      if (prior(j) < impossible_probability) continue;
      const VectorXd by_pair = (by_weight.col(j).array() - mean_by_weight(j)) / prior(j) + by_prior_(j);
      sum_.transition.col(j) += by_pair.cwiseProduct(before.mode_probability);
      by.probability += by_pair.cwiseProduct(model_.transition.matrix().col(j));
    }
    by_ = std::move(by);
  }
};

}  // namespace

bool has_dense_gradient(const Bank& bank, const FilterOptions& options) {
  return (options.variant == FilterVariant::imm || (options.variant == FilterVariant::kf && bank.mode_count() == 1)) &&
         options.noise == FilterNoise::gaussian && !bank.is_quantised() && bank.transition_logit.empty() &&
         bank.drift.empty() && bank.terms.empty() && bank.noise_factor.empty();
}

BankGradient dense_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  return DenseGradient(bank, run, options).go_back();
}

}  // namespace modebank
