#pragma once

#include <string>
#include <utility>
#include <vector>

#include "filter/step/drifting.hpp"
#include "io/archive/bank/layout_bank.hpp"

/// The layout of the drifting competitor; see io/archive/layout.hpp. p parameters, r regressors, n_y outputs, H
/// horizons.
namespace modebank::layout {

/// The factors of a drifting model by their horizons, as two arrays.
struct StoredFactors {
  Eigen::VectorXd horizon, factor;
};

inline StoredFactors store_factors(const std::vector<std::pair<Eigen::Index, double>>& factors) {
  StoredFactors stored{Eigen::VectorXd(factors.size()), Eigen::VectorXd(factors.size())};
  for (std::size_t i = 0; i < factors.size(); ++i) {
    stored.horizon(static_cast<Eigen::Index>(i)) = static_cast<double>(factors[i].first);
    stored.factor(static_cast<Eigen::Index>(i)) = factors[i].second;
  }
  return stored;
}

inline std::vector<std::pair<Eigen::Index, double>> restore_factors(const StoredFactors& stored) {
  std::vector<std::pair<Eigen::Index, double>> factors;
  for (Eigen::Index i = 0; i < std::min(stored.horizon.size(), stored.factor.size()); ++i)
    factors.emplace_back(static_cast<Eigen::Index>(stored.horizon(i)), stored.factor(i));
  return factors;
}

/// /drifting: one motion whose coefficients wander.
/// - states: number of measured states
/// - q: variance that a step adds to every coefficient
/// - p0: variance of the coefficients at the start
/// - leak: share of their difference from `parameters` that a step leaves
/// - wandering: `constant` or `gain` (one factor on the inputs' coefficients); absent: all coefficients
/// - lam: forgetting factor of the running variance
/// - nu: degrees of freedom of the noise; 0: Gaussian
/// - training_log_score: [nat] per sample
/// - at_grid_end: names of settings that ended at the end of their grid
/// - parameters: where the coefficients start
/// - regressor_scale: root mean square of each regressor
/// - initial_variance: variance of the training residuals
/// - variance_floor: least noise variance
/// - quantum: step of the measured values; 0: continuous
/// - horizon: samples ahead
/// - horizon_factor: factor on the variance at each horizon
template <class Io, class M>
void exchange_drifting(Io& io, M& model, const Units& units) {
  io.attribute_texts("state_names", model.state_names);
  io.attribute_texts("input_names", model.input_names);
  io.attribute("dt_s", model.dt_s, rule::positive);
  io.attribute("states", model.structure.states, rule::between(1, rule::channels.most));
  std::string name = "varx";
  exchange_structure(io, model.structure, name);
  io.attribute("q", model.rates.q);
  io.attribute("p0", model.rates.p0);
  io.attribute("leak", model.rates.leak);
  io.attribute_unless(Wandering::all, "wandering", model.wandering);
  io.attribute("lam", model.lam);
  io.attribute("nu", model.nu);
  io.attribute("training_log_score", model.tuning.log_score);
  io.attribute("training_samples", model.tuning.samples, rule::not_negative);
  io.attribute_texts("at_grid_end", model.tuning.at_grid_end);
  io.field("parameters", model.theta0, {"p"}, parameter_units(model.structure, units.states(), units.inputs()));
  io.field("regressor_scale", model.scale, {"r"});
  io.field("initial_variance", model.v0, {"n_y"}, squared(units.states()));
  io.field("variance_floor", model.variance_floor, {"n_y"}, squared(units.states()));
  io.optional_field("quantum", model.quantum, {"n_y"}, units.states());
  io.through(model.horizon_factor, store_factors, restore_factors, [&](auto& stored) {
    io.optional_field("horizon", stored.horizon, {"H"}, {"samples"}, rule::between(2, 1e6));
    io.optional_field("horizon_factor", stored.factor, {"H"});
  });
  if constexpr (Io::reads)
    io.finish([&] {
      validate(model);
      check_count("state_names", model.state_names, static_cast<std::size_t>(model.structure.dimension()));
      check_count("input_names", model.input_names, static_cast<std::size_t>(model.structure.acting_inputs()));
    });
}

}  // namespace modebank::layout
