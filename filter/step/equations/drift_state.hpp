#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"

/// What modes that drift (drift.hpp) have beside those that do not. p = parameters(), n = dimension(), K modes.
namespace modebank {

template <int N, int NY>
struct FilterModel;

/// What a filter knows of the modes' coefficients; covariances of coefficients in units of the noise scale.
struct DriftState {
  Eigen::MatrixXd theta;               ///< p x K
  std::vector<Eigen::MatrixXd> P;      ///< K of p x p
  std::vector<Eigen::MatrixXd> cross;  ///< K of p x n: of theta with the state's error; 0 where the state is known
};

/// How the bank's coefficients wander, laid out for stepping.
struct DriftModel {
  double leak = 1.0;
  Eigen::MatrixXd theta0;           ///< p x K; empty: nothing drifts
  std::vector<Eigen::MatrixXd> W;   ///< K of p x p, what a step adds to P
  std::vector<Eigen::MatrixXd> P0;  ///< K of p x p, P at a start

  /// W_k = q Q_k (x) D^-2 and P0_k the same with p0: D the regressors' scales, Q_k of the measured states.
  explicit DriftModel(const Bank& bank) {
    if (bank.drift.empty()) return;
    const LinearStructure& s = bank.structure;
    const Eigen::Index r = s.regressors(), p = s.parameters();
    leak = bank.drift.rates.leak;
    theta0.resize(p, bank.mode_count());
    for (Eigen::Index k = 0; k < bank.mode_count(); ++k) {
      theta0.col(k) = bank.theta(k);
      Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(p, p);
      for (Eigen::Index b = 0; b < s.states; ++b)
        for (Eigen::Index a = 0; a < s.states; ++a)
          unit.block(a * r, b * r, r, r).diagonal() =
              bank.modes[static_cast<std::size_t>(k)].Q(a, b) * bank.drift.scale.array().square().inverse();
      W.push_back(bank.drift.rates.q * unit);
      P0.push_back(bank.drift.rates.p0 * unit);
    }
  }

  bool on() const { return theta0.size() > 0; }

  void restart(DriftState& state) const {
    state.theta = theta0;
    for (std::size_t k = 0; k < P0.size(); ++k) {
      state.P[k] = P0[k];
      state.cross[k].setZero();
    }
  }
  DriftState start(Eigen::Index dimension) const {
    return {theta0, P0, std::vector<Eigen::MatrixXd>(P0.size(), Eigen::MatrixXd::Zero(theta0.rows(), dimension))};
  }
};

/// Where a step of modes that drift is worked out, sized once.
template <int N, int NY>
struct DriftWorkspace {
  std::vector<typename FilterModel<N, NY>::Mode> modes;  ///< K, as their coefficients stand
  std::vector<Eigen::MatrixXd> cross;                    ///< K of p x n, of theta with the predicted state's error
  Eigen::VectorXd regressor, move;                       ///< r, p
  Eigen::MatrixXd through;                               ///< states x n, (I (x) phi') cross
  Eigen::MatrixXd PG, G, gain, seen;                     ///< p x states, p x n_y, p x n_y, n x n_y
  Eigen::VectorXd row;                                   ///< n_y

  explicit DriftWorkspace(const FilterModel<N, NY>& model) {
    if (!model.drift.on()) return;
    const Eigen::Index p = model.drift.theta0.rows(), n = model.structure.dimension(), n_y = model.C.rows();
    modes = model.modes;
    cross.assign(modes.size(), Eigen::MatrixXd::Zero(p, n));
    regressor.resize(model.structure.regressors());
    move.resize(p);
    through.resize(model.structure.states, n);
    PG.resize(p, model.structure.states);
    G.resize(p, n_y);
    gain.resize(p, n_y);
    seen.resize(n, n_y);
    row.resize(n_y);
  }
};

}  // namespace modebank
