#include "tests/bench/window_peers.hpp"

#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

namespace modebank::bench {
namespace {

constexpr double tolerance = 1e-10;

struct Residual {
  double x, left, right, increment;
  template <class T>
  bool operator()(const T* p, T* r) const {
    r[0] = p[0] * x + p[1] * left + p[2] * right - increment;
    return true;
  }
};

ceres::LossFunction* make_loss(Loss loss, double scale) {
  switch (loss) {
    case Loss::trivial:
      return nullptr;
    case Loss::huber:
      return new ceres::HuberLoss(scale);
    case Loss::cauchy:
      return new ceres::CauchyLoss(scale);
    case Loss::softlone:
      return new ceres::SoftLOneLoss(scale);
    default:
      throw std::invalid_argument("no peer for this loss");
  }
}

ceres::Solver::Options solver_options() {
  ceres::Solver::Options options;
  options.function_tolerance = options.gradient_tolerance = tolerance * 1e-2;
  options.parameter_tolerance = tolerance;
  options.max_num_iterations = 200;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.linear_solver_type = ceres::DENSE_QR;
  return options;
}

void keep_triangle(const Eigen::Matrix3d& covariance, PeerFit& fit) {
  int entry = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) fit.covariance[entry++] = covariance(i, j);
}

/// The whole window as one block of residuals sign(r) sqrt(rho).
struct TinyFunction {
  using Scalar = double;
  enum { NUM_RESIDUALS = peer_length, NUM_PARAMETERS = 3 };
  const double *x, *left, *right, *increment;
  const ceres::LossFunction* loss;
  bool operator()(const double* p, double* r, double* J) const {
    for (int i = 0; i < peer_length; ++i) {
      const double e = p[0] * x[i] + p[1] * left[i] + p[2] * right[i] - increment[i];
      double rho[3] = {e * e, 1.0, 0.0};
      if (loss) loss->Evaluate(e * e, rho);
      const bool square = rho[0] < 1e-300 || rho[1] == 1.0;
      const double root = square ? std::abs(e) : std::sqrt(rho[0]);
      const double slope = square ? 1.0 : rho[1] * std::abs(e) / root;
      r[i] = std::copysign(root, e);
      if (!J) continue;
      J[i] = slope * x[i];
      J[peer_length + i] = slope * left[i];
      J[2 * peer_length + i] = slope * right[i];
    }
    return true;
  }
};

}  // namespace

void fit_naive_ceres(const PeerData& data, Loss loss, double scale, Index windows, PeerFit* fits) {
  const ceres::Solver::Options options = solver_options();
  for (Index k = 0; k < windows; ++k) {
    double p[3] = {0, 0, 0};
    ceres::Problem problem;
    for (auto i = static_cast<std::size_t>(k); i < static_cast<std::size_t>(k) + peer_length; ++i)
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 1, 3>(
                                   new Residual{data.x[i], data.left[i], data.right[i], data.increment[i]}),
                               make_loss(loss, scale), p);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    ceres::Covariance covariance{ceres::Covariance::Options()};
    const std::vector<std::pair<const double*, const double*>> blocks{{p, p}};
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> C = Eigen::Matrix3d::Zero();
    if (covariance.Compute(blocks, &problem)) covariance.GetCovarianceBlock(p, p, C.data());
    std::copy(p, p + 3, fits[k].theta);
    keep_triangle(C, fits[k]);
  }
}

void fit_tiny_solver(const PeerData& data, Loss loss, double scale, Index windows, PeerFit* fits) {
  const std::unique_ptr<ceres::LossFunction> function(make_loss(loss, scale));
  ceres::TinySolver<TinyFunction> solver;
  solver.options.max_num_iterations = 200;
  solver.options.gradient_tolerance = tolerance * 1e-2;
  solver.options.parameter_tolerance = tolerance;
  solver.options.function_tolerance = 1e-18;
  solver.options.cost_threshold = 1e-300;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (Index k = 0; k < windows; ++k) {
    const TinyFunction window{&data.x[k], &data.left[k], &data.right[k], &data.increment[k], function.get()};
    solver.Solve(window, &p);
    std::copy(p.data(), p.data() + 3, fits[k].theta);
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    for (int i = 0; i < peer_length; ++i) {
      const Eigen::Vector3d phi(window.x[i], window.left[i], window.right[i]);
      const double e = p.dot(phi) - window.increment[i];
      double rho[3] = {0.0, 1.0, 0.0};
      if (function) function->Evaluate(e * e, rho);
      H += rho[1] * phi * phi.transpose();
    }
    keep_triangle(H.inverse(), fits[k]);
  }
}

}  // namespace modebank::bench
