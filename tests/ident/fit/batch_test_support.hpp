#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/fit/detail/batch/solver.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank::test {

using Real = long double;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// One window's data in extended precision.
struct Regression {
  RealMatrix X;
  RealVector y;
};

inline Regression window_of(const Trajectory& run, Index start, Index length, const LinearStructure& structure) {
  const Transitions t = finite_rows(stack_transitions(run, start, length, structure));
  return {t.regressors.cast<Real>(), t.increments.col(0).cast<Real>()};
}

/// rho, rho' and rho' + 2 s rho'' at a residual in units of sigma, from the losses' definitions.
struct ReferenceLoss {
  Real rho, weight, slope;
};

inline ReferenceLoss reference_loss(Loss loss, Real c, Real r) {
  const Real s = r * r, t = s / (c * c), a = std::fabs(r);
  switch (loss) {
    case Loss::trivial:
      return {s, 1, 1};
    case Loss::huber:
      return a <= c ? ReferenceLoss{s, 1, 1} : ReferenceLoss{2 * c * a - c * c, c / a, 0};
    case Loss::softlone: {
      const Real u = std::sqrt(1 + t);
      return {2 * s / (1 + u), 1 / u, 1 / (u * u * u)};
    }
    case Loss::cauchy:
      return {c * c * std::log1p(t), 1 / (1 + t), (1 - t) / ((1 + t) * (1 + t))};
    case Loss::tukey:
      if (t >= 1) return {c * c / 3, 0, 0};
      return {c * c / 3 * (1 - (1 - t) * (1 - t) * (1 - t)), (1 - t) * (1 - t), (1 - t) * (1 - 5 * t)};
    default: {
      const Real w = 1 / (1 + t * t);
      return {c * c * std::atan(t), w, w * w * (1 - 3 * t * t)};
    }
  }
}

/// The objective, half of its gradient, and its second derivative, per unit of sigma^2.
struct ReferenceTerms {
  Real cost = 0;
  RealVector gradient;
  RealMatrix hessian, weighted;
  Real psi_square = 0;
};

struct ReferenceProblem {
  Loss loss;
  Real c, sigma;
  RealVector mean, precision;  ///< mean and precision of the prior; empty without a prior

  ReferenceTerms terms(const Regression& w, const RealVector& theta) const {
    const Index q = w.X.cols();
    ReferenceTerms out{0, RealVector::Zero(q), RealMatrix::Zero(q, q), RealMatrix::Zero(q, q), 0};
    const RealVector r = (w.y - w.X * theta) / sigma;
    for (Index k = 0; k < r.size(); ++k) {
      const ReferenceLoss l = reference_loss(loss, c, r(k));
      const RealVector x = w.X.row(k).transpose() / sigma;
      out.cost += l.rho;
      out.gradient -= l.weight * r(k) * x;
      out.hessian += l.slope * x * x.transpose();
      out.weighted += l.weight * x * x.transpose();
      out.psi_square += l.weight * r(k) * l.weight * r(k);
    }
    if (mean.size() == 0) return out;
    const RealVector away = theta - mean;
    out.cost += away.dot(precision.cwiseProduct(away));
    out.psi_square += away.dot(precision.cwiseProduct(away));
    out.gradient += precision.cwiseProduct(away);
    out.hessian.diagonal() += precision;
    out.weighted.diagonal() += precision;
    return out;
  }

  /// |Q' psi| / |psi|, where Q is an orthonormal basis of the regressors and the prior's rows.
  double relative_gradient(const Regression& w, const RealVector& theta) const {
    const ReferenceTerms t = terms(w, theta);
    RealMatrix gram = w.X.transpose() * w.X / (sigma * sigma);
    if (mean.size() > 0) gram.diagonal() += precision;
    const Real square = t.gradient.dot(gram.ldlt().solve(t.gradient));
    return static_cast<double>(std::sqrt(std::max<Real>(square, 0) / t.psi_square));
  }

  /// Newton's method from least squares, for convex losses. Steps are halved until the cost falls. They are damped if
  /// the second derivative is singular.
  RealVector minimum(const Regression& w) const {
    const ReferenceProblem squares{Loss::trivial, 1, sigma, mean, precision};
    RealVector theta = mean.size() > 0 ? mean : RealVector::Zero(w.X.cols()).eval();
    for (int pass = 0; pass < 3; ++pass) {
      const ReferenceTerms t = squares.terms(w, theta);
      theta -= t.hessian.ldlt().solve(t.gradient);
    }
    for (int iteration = 0; iteration < 200; ++iteration) {
      const ReferenceTerms t = terms(w, theta);
      const Eigen::LLT<RealMatrix> exact(t.hessian);
      const bool definite = exact.info() == Eigen::Success && exact.rcond() > 1e-12L;
      const RealMatrix damped = t.hessian + 0.01L * t.weighted;
      RealVector step = definite ? exact.solve(t.gradient).eval() : damped.ldlt().solve(t.gradient).eval();
      for (int halving = 0; halving < 60 && terms(w, theta - step).cost > t.cost; ++halving) step *= 0.5L;
      theta -= step;
      if (step.norm() <= 1e-17L * (theta.norm() + 1e-300L)) break;
    }
    return theta;
  }
};

/// Number of windows that the batch solver solved.
inline Index by_batch(const WindowFits& fits) { return std::count(fits.by_batch.begin(), fits.by_batch.end(), 1); }

/// A recording with changes of regime, 5 % outliers, a stretch of standstill and missing samples.
inline Recording hard_recording(const LinearStructure& structure, Index samples, bool missing) {
  std::mt19937_64 generator(11);
  std::vector<Trajectory> runs;
  for (int i = 0; i < 3; ++i) {
    Eigen::VectorXd theta = Eigen::VectorXd::LinSpaced(structure.parameters(), -0.4, 0.5);
    theta(0) = -0.4;
    runs.push_back(gaussian_run(structure, theta, 0.05, samples, generator));
    Trajectory& run = runs.back();
    run.run = std::to_string(i);
    for (Index k = 0; k < samples; ++k)
      if (generator() % 20 == 0) run.state(0, k) += generator() % 2 ? 1.5 : -0.7;
    if (structure.inputs > 1)
      run.input.middleCols(samples / 2, 40).colwise() = Eigen::VectorXd::Constant(structure.inputs, 0.3);
    if (missing) run.state(0, samples / 4) = run.input(0, samples / 3) = std::nan("");
  }
  return make_recording(runs);
}

}  // namespace modebank::test
