#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "modebank/ident/input_delays.hpp"

namespace modebank {

/// Structure of the linear increment model x[k+1] = x[k] + A x[k] + B u[k] (+ c) + w[k] (Salvi et al. 2025, eq. 1),
/// extended to lags: a VARX model in increment form (Ljung 1999, section 4.2):
///   x[k+1] = x[k] + sum_{i=1..state_lags} A_i x[k+1-i] + sum_{j=0..input_lags-1} B_j u[k+1-d-j] (+ c)
///          + w[k]. theta is the row-major vec of [A_1 A_2 ... B_0 B_1 ... (c)]: row i predicts the increment of state
///          i. In state space the lagged samples are further states: z[k] = [x[k]; x[k-1]; ...] has dimension n =
///          states * state_lags. The inputs that act on transition k are v[k] = [u[k+1-d]; u[k-d]; ...]. Each input
///          has its own delay d. Fits, filters and simulation all use the equation of this header.
struct LinearStructure {
  Eigen::Index states = 1;          ///< measured states
  Eigen::Index inputs = 0;          ///< input channels
  bool intercept = false;           ///< whether the constant c is estimated
  Eigen::Index state_lags = 1;      ///< number of samples x[k], x[k-1], ... that predict x[k+1]; at least 1
  Eigen::Index input_lags = 1;      ///< number of input samples that act on one transition; at least 1
  InputDelays input_delay = 1;      ///< number of samples from each input to its first effect
  std::vector<double> centre = {};  ///< states, then inputs: theta is taken about this point, so that the constant of
                                    ///< theta is the increment there. Empty: zero. A, B and c of models are not changed

  Eigen::Index dimension() const { return states * state_lags; }                                   ///< n, size of z
  Eigen::Index acting_inputs() const { return inputs * input_lags; }                               ///< m, size of v
  Eigen::Index regressors() const { return dimension() + acting_inputs() + (intercept ? 1 : 0); }  ///< q
  Eigen::Index parameters() const { return states * regressors(); }                                ///< p
  bool lagged() const { return state_lags != 1 || input_lags != 1 || input_delay != 1; }
  /// Whether predictions use samples older than the newest one.
  bool has_several_lags() const { return state_lags > 1 || input_lags > 1; }
  /// The same structure with one state lag and one input lag.
  LinearStructure with_one_lag() const { return {states, inputs, intercept, 1, 1, input_delay, centre}; }
  /// Entry j of the centre, repeated for the lags of [z; v]. Requires a centre.
  double centre_of(Eigen::Index j) const {
    return centre[static_cast<std::size_t>(j < dimension() ? j % states : states + (j - dimension()) % inputs)];
  }
  /// The centre of [z; v]; zeros without a centre.
  Eigen::VectorXd acting_centre() const;
  /// First transition of a run whose regressors all lie inside the run.
  Eigen::Index first_transition() const {
    return std::max<Eigen::Index>({0, state_lags - 1, input_delay.latest() + input_lags - 2});
  }
  /// "A", "B1", "B2", "c" for one state; "A11", "A12", "B11", ..., "c1" for several. With lags a suffix gives the
  /// number of samples before the predicted one: "A_lag1", "A_lag2", "B1_lag0".
  std::vector<std::string> parameter_names() const;
  bool operator==(const LinearStructure&) const = default;
};

/// phi = [z; v; (1)], the q regressors of one transition, z and v about the centre.
template <class Z, class V, class Phi>
void fill_regressor(const LinearStructure& s, const Z& z, const V& v, Phi&& phi) {
  phi.head(s.dimension()) = z;
  phi.segment(s.dimension(), s.acting_inputs()) = v;
  for (Eigen::Index j = 0; !s.centre.empty() && j < z.size() + v.size(); ++j) phi(j) -= s.centre_of(j);
  if (s.intercept) phi(s.regressors() - 1) = typename std::decay_t<Phi>::Scalar(1);
}

/// next = x + A x + B u + c; `next` must not alias x. The order of summation is the same for fixed and dynamic sizes,
/// so all callers get the same result to the last bit. Does not allocate.
template <class MatrixA, class MatrixB, class VectorC, class X, class U, class Next>
void propagate(const MatrixA& A, const MatrixB& B, const VectorC& c, const X& x, const U& u, Next& next) {
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    auto increment = c(i);
    for (Eigen::Index j = 0; j < A.cols(); ++j) increment += A(i, j) * x(j);
    for (Eigen::Index j = 0; j < B.cols(); ++j) increment += B(i, j) * u(j);
    next(i) = x(i) + increment;
  }
}

/// The matrices of one parameter vector in state space; A is in companion form if there are lags.
struct LinearModel {
  Eigen::MatrixXd A;  ///< n x n, increment form; the full form is I + A
  Eigen::MatrixXd B;  ///< n x m
  Eigen::VectorXd c;  ///< n, the constant; zero without an intercept

  /// Noise-free x[k+1].
  template <class X, class U>
  Eigen::VectorXd next(const X& x, const U& u) const {
    Eigen::VectorXd result(x.size());
    propagate(A, B, c, x, u, result);
    return result;
  }
  /// I + A, the matrix of the full form x[k+1] = (I + A) x[k] + ...
  Eigen::MatrixXd full_form() const { return A + Eigen::MatrixXd::Identity(A.rows(), A.cols()); }
};

/// Largest absolute eigenvalue of I + A; infinite if A is not finite.
double spectral_radius(const LinearModel& model);

/// Converts theta to matrices with companion rows, and back. pack ignores the companion rows.
LinearModel unpack(const LinearStructure& structure, const Eigen::VectorXd& theta);
Eigen::VectorXd pack(const LinearStructure& structure, const LinearModel& model);

}  // namespace modebank
