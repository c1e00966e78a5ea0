#pragma once

#include <Eigen/Core>

namespace modebank {

/// State-dependent transition probabilities, a multinomial logit (McFadden 1974). In the step from k to k + 1, mode j
/// follows mode i with the probability
///   P(j | i, z[k]) = T_ij exp(w_j' (z[k] - reference)) / sum_l T_il exp(w_l' (z[k] - reference)).
/// z[k] = (x[k], v[k]) holds the state at the start of the step and the acting inputs. Both are known before the
/// measurement of sample k + 1. Without weights the probabilities are T. A constant added to a column of the weights
/// has no effect.
struct TransitionLogit {
  Eigen::MatrixXd weights = {};    ///< K x d, d = n + acting inputs [1 / unit of z]; if empty, T holds for every z
  Eigen::VectorXd reference = {};  ///< d, the value of z for which T holds

  bool empty() const { return weights.size() == 0; }
};

/// Workspace for the transition probabilities of a step, sized once.
struct TransitionWorkspace {
  TransitionWorkspace(Eigen::Index modes, const TransitionLogit& logit)
      : offset(logit.empty() ? Eigen::VectorXd() : Eigen::VectorXd(logit.weights * logit.reference)) {
    if (logit.empty()) return;
    T.resize(modes, modes);
    factor.resize(modes);
  }

  Eigen::MatrixXd T;       ///< K x K; each row sums to one
  Eigen::VectorXd factor;  ///< K
  Eigen::VectorXd offset;  ///< K, the product of weights and reference
};

/// Upper limit of the difference of log odds. Larger differences are practically certain. The limit keeps every row of
/// T possible.
inline constexpr double largest_log_odds = 200.0;

/// The probabilities at (x, v). The result is T if x or v is not finite. Does not allocate.
template <class X, class V>
const Eigen::MatrixXd& transition_at(const Eigen::MatrixXd& T, const TransitionLogit& logit, const X& x, const V& v,
                                     TransitionWorkspace& at) {
  if (logit.empty()) return T;
  const Eigen::Index K = T.rows(), n = x.size();
  at.factor = -at.offset;
  for (Eigen::Index a = 0; a < n; ++a) at.factor += logit.weights.col(a) * x(a);
  for (Eigen::Index a = 0; a < v.size(); ++a) at.factor += logit.weights.col(n + a) * v(a);
  if (!at.factor.allFinite()) return T;
  at.factor = (at.factor.array() - at.factor.maxCoeff()).max(-largest_log_odds).exp();
  for (Eigen::Index i = 0; i < K; ++i) {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < K; ++j) sum += at.T(i, j) = T(i, j) * at.factor(j);
    for (Eigen::Index j = 0; j < K; ++j) at.T(i, j) /= sum;
  }
  return at.T;
}

}  // namespace modebank
