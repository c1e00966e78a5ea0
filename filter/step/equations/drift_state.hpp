#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "filter/step/bank.hpp"

/// Additional state of modes that drift (drift.hpp). p = parameters(), n = dimension(), K modes.
namespace modebank {

template <int N, int NY>
struct FilterModel;

/// Estimates of the modes' coefficients; covariances are in units of the noise scale. Modes that share theta
/// (DriftModel::shared) have one column and one P. With running noise (DriftingRecursion), theta is for scaled
/// regressors, each output has its own P (r x r, lower triangle) divided by its variance, and cross is empty.
struct DriftState {
  Eigen::MatrixXd theta = {};               ///< p x K
  std::vector<Eigen::MatrixXd> P = {};      ///< K matrices p x p
  std::vector<Eigen::MatrixXd> cross = {};  ///< K matrices p x n: covariance of theta with the state's error; 0 if the
                                            ///< state is known exactly
  Eigen::VectorXd variance = {};            ///< n, running noise variance; empty without running noise
};

/// The bank's drift in the layout for stepping.
struct DriftModel {
  double leak = 1.0;
  bool shared = false;              ///< whether modes differ only in noise and share theta with its updates
  Eigen::MatrixXd theta0;           ///< p x K; p x 1 if modes share theta; empty without drift
  std::vector<Eigen::MatrixXd> W;   ///< K matrices p x p (one if modes share theta), added to P per step
  std::vector<Eigen::MatrixXd> P0;  ///< K matrices p x p (one if modes share theta), P at a start

  /// W_k = q Q_k (x) D^-2 and P0_k = p0 Q_k (x) D^-2. D holds the scales of the regressors; Q_k is the process noise of
  /// the measured states. Modes that share theta use their mean Q, weighted with the weights of the modes.
  explicit DriftModel(const Bank& bank) : modes_(bank.modes.size()) {
    if (bank.drift.empty()) return;
    leak = bank.drift.rates.leak;
    shared = has_one_theta(bank);
    if (shared) {
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(bank.modes[0].Q.rows(), bank.modes[0].Q.cols());
      double weight = 0.0;
      for (const Mode& mode : bank.modes) {
        sum += mode.weight * mode.Q;
        weight += mode.weight;
      }
      add(bank, 0, sum / weight);
    } else {
      for (std::size_t k = 0; k < modes_; ++k) add(bank, k, bank.modes[k].Q);
    }
  }

  bool on() const { return theta0.size() > 0; }
  /// Index of mode k's theta: 0 if modes share theta.
  std::size_t owner(std::size_t k) const { return shared ? 0 : k; }

  void restart(DriftState& state) const {
    state.theta = theta0;
    for (std::size_t k = 0; k < P0.size(); ++k) state.P[k] = P0[k];
    for (Eigen::MatrixXd& cross : state.cross) cross.setZero();
  }
  DriftState start(Eigen::Index dimension) const {
    if (!on()) return {};
    return {theta0, P0, std::vector<Eigen::MatrixXd>(modes_, Eigen::MatrixXd::Zero(theta0.rows(), dimension))};
  }

 private:
  std::size_t modes_;

  void add(const Bank& bank, std::size_t k, const Eigen::MatrixXd& Q) {
    const LinearStructure& s = bank.structure;
    const Eigen::Index r = s.regressors(), p = s.parameters();
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(p, p);
    for (Eigen::Index b = 0; b < s.states; ++b)
      for (Eigen::Index a = 0; a < s.states; ++a)
        unit.block(a * r, b * r, r, r).diagonal() = Q(a, b) * bank.drift.scale.array().square().inverse();
    theta0.conservativeResize(p, static_cast<Eigen::Index>(k) + 1);
    theta0.rightCols<1>() = bank.theta(static_cast<Eigen::Index>(k));
    W.push_back(bank.drift.rates.q * unit);
    P0.push_back(bank.drift.rates.p0 * unit);
  }
};

/// Workspace for a step of modes that drift, sized once.
template <int N, int NY>
struct DriftWorkspace {
  std::vector<typename FilterModel<N, NY>::Mode> modes;  ///< K modes with their present coefficients
  std::vector<Eigen::MatrixXd> cross;                    ///< K matrices p x n, covariance of theta with the predicted
                                                         ///< state's error
  Eigen::VectorXd regressor, move, together;             ///< sizes: r, p, p
  Eigen::MatrixXd mixed;              ///< p x n, covariance of theta with the state at which a prediction starts
  Eigen::MatrixXd through;            ///< states x n, (I (x) phi') cross
  Eigen::MatrixXd PG, G, gain, seen;  ///< p x states, p x n_y, p x n_y, n x n_y
  Eigen::VectorXd row;                ///< n_y

  explicit DriftWorkspace(const FilterModel<N, NY>& model) {
    if (!model.drift.on()) return;
    const Eigen::Index p = model.drift.theta0.rows(), n = model.structure.dimension(), n_y = model.C.rows();
    modes = model.modes;
    cross.assign(modes.size(), Eigen::MatrixXd::Zero(p, n));
    regressor.resize(model.structure.regressors());
    move.resize(p);
    together.resize(p);
    mixed.resize(p, n);
    through.resize(model.structure.states, n);
    PG.resize(p, model.structure.states);
    G.resize(p, n_y);
    gain.resize(p, n_y);
    seen.resize(n, n_y);
    row.resize(n_y);
  }
};

namespace drift {

/// Repairs a covariance that rounding made indefinite (if samples have very different sizes). The variances stay and
/// the correlations are set to zero. So variances grow only by the additions per step, and nothing overflows.
inline void make_usable(Eigen::MatrixXd& P) {
  if (P.diagonal().minCoeff() >= 0.0) return;
  for (Eigen::Index j = 0; j < P.cols(); ++j)
    for (Eigen::Index i = 0; i < P.rows(); ++i) P(i, j) = i == j ? std::max(0.0, P(i, i)) : 0.0;
}

}  // namespace drift
}  // namespace modebank
