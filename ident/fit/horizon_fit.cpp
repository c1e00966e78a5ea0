#include "ident/fit/horizon_fit.hpp"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {
namespace {

/// The samples after one origin of a run, and what predicts them.
struct Ahead {
  Eigen::MatrixXd regressors;  ///< samples x q; only the inputs of later rows are used
  Eigen::MatrixXd rise;        ///< n x samples, measured value minus that of the origin

  Ahead(const LinearStructure& s, const Trajectory& run, Index origin, Index horizon) {
    const Index samples = std::min(horizon, run.transitions() - origin);
    regressors = stack_transitions(run, origin, samples, s).regressors;
    rise = run.state.middleCols(origin + 1, samples).colwise() - run.state.col(origin);
  }
  Index samples() const { return rise.cols(); }
  bool starts() const { return samples() > 0 && regressors.row(0).allFinite(); }

  /// Measured minus predicted, n x samples.
  template <class T>
  Eigen::MatrixX<T> errors(const LinearStructure& s, const T* theta) const {
    const Index n = s.states, q = s.regressors(), lagged = s.dimension();
    const Eigen::Map<const Eigen::MatrixX<T>> coefficients(theta, q, n);
    Eigen::MatrixX<T> result(n, samples());
    Eigen::VectorX<T> phi = regressors.row(0).transpose().cast<T>();
    const Eigen::VectorX<T> origin = phi.head(n);
    for (Index k = 0; k < samples(); ++k) {
      phi.tail(q - lagged) = regressors.row(k).tail(q - lagged).transpose().cast<T>();
      const Eigen::VectorX<T> next = phi.head(n) + coefficients.transpose() * phi;
      result.col(k) = rise.col(k).cast<T>() - (next - origin);
      phi.segment(n, lagged - n) = phi.head(lagged - n).eval();
      phi.head(n) = next;
    }
    return result;
  }
};

/// The residuals of one origin for Ceres, in units of `unit`; zero for missing measurements.
struct HorizonErrors {
  const LinearStructure& structure;
  const Ahead& ahead;
  const Eigen::VectorXd& unit;

  template <class T>
  bool operator()(T const* const* theta, T* r) const {
    const Eigen::MatrixX<T> errors = ahead.errors(structure, theta[0]);
    for (Index i = 0; i < errors.size(); ++i)
      r[i] = std::isnan(ahead.rise.data()[i]) ? T() : errors.data()[i] / unit(i % unit.size());
    return true;
  }
};

}  // namespace

Eigen::MatrixXd errors_ahead(const LinearStructure& structure, const Eigen::VectorXd& theta, const Trajectory& run,
                             Index origin, Index horizon) {
  const Ahead ahead(structure, run, origin, horizon);
  return ahead.starts() ? ahead.errors(structure, theta.data())
                        : Eigen::MatrixXd::Constant(structure.states, ahead.samples(), not_a_number);
}

Eigen::VectorXd fit_over_horizon(const Recording& recording, const LinearStructure& structure,
                                 const Eigen::VectorXd& start, Index horizon) {
  std::vector<Ahead> origins;
  for (const Trajectory& run : recording.runs)
    for (Index k = structure.first_transition(); run.role == Role::train && k < run.transitions();
         k += (horizon + 3) / 4)
      if (Ahead ahead(structure, run, k, horizon); ahead.starts()) origins.push_back(ahead);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(structure.states);
  for (const Ahead& ahead : origins) {
    const Eigen::ArrayXXd errors = ahead.errors(structure, start.data()).array();
    squares += errors.isNaN().select(0.0, errors.square()).rowwise().sum().matrix();
  }
  if (!(squares.minCoeff() > 0.0)) return start;
  const Eigen::VectorXd unit = squares.cwiseSqrt();
  ceres::Problem problem;
  Eigen::VectorXd theta = start;
  for (const Ahead& ahead : origins) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<HorizonErrors>(new HorizonErrors{structure, ahead, unit});
    cost->AddParameterBlock(static_cast<int>(theta.size()));
    cost->SetNumResiduals(static_cast<int>(ahead.rise.size()));
    problem.AddResidualBlock(cost, nullptr, theta.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;  // this solver does not square the condition number
  options.max_num_iterations = 200;
  options.function_tolerance = options.parameter_tolerance = options.gradient_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return theta;  // the start if Ceres fails
}

}  // namespace modebank
