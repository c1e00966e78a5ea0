#pragma once

#include <string>
#include <vector>

#include "io/archive/bank/layout_bank.hpp"

/// The layout of the drifting competitor; see io/archive/layout.hpp. Letters: p parameters, r regressors, n_y outputs,
/// H horizons, J noise levels.
namespace modebank::layout {

/// /drifting: one motion whose coefficients drift.
/// - states: number of measured states
/// - q: variance that a step adds to every coefficient
/// - p0: variance of the coefficients at the start
/// - leak: factor by which a step multiplies the difference between the coefficients and `parameters`
/// - lam: forgetting factor of the running variance
/// - nu: degrees of freedom of the noise; 0: Gaussian
/// - training_log_score: log score [nat] per sample of the training runs
/// - parameters: coefficients at the start of a run
/// - regressor_scale: root mean square of each regressor
/// - initial_variance: variance of the training residuals
/// - variance_floor: least noise variance
/// - quantum: step of the measured values; 0: continuous
/// - noise_level: variance of the noise in each level, in units of the running variance; absent: one level of 1
/// - level_transition: probabilities of the next level, by rows
/// - horizon: number of samples ahead
/// - horizon_factor: factor that multiplies the variance at each horizon
template <class Io, class B>
void exchange_drifting(Io& io, B& bank, const Units& units) {
  io.attribute_texts("state_names", bank.state_names);
  io.attribute_texts("input_names", bank.input_names);
  io.attribute("dt_s", bank.dt_s, rule::positive);
  io.attribute("lam", bank.running_noise.lam);
  io.attribute("nu", bank.running_noise.nu);
  io.attribute("training_log_score", bank.drift.tuning.log_score);
  io.attribute("training_samples", bank.drift.tuning.samples, rule::not_negative);
  io.attribute("q", bank.drift.rates.q);
  io.attribute("p0", bank.drift.rates.p0);
  io.attribute("leak", bank.drift.rates.leak);
  io.field("variance_floor", bank.running_noise.floor, {"n_y"}, squared(units.states()));
  io.optional_field("quantum", bank.quantum, {"n_y"}, units.states());
  io.through(
      bank, store_drifting, [&](const StoredDrifting& stored) { return restore_drifting(stored, bank); },
      [&](auto& stored) {
        io.attribute("states", stored.structure.states, rule::between(1, rule::channels.most));
        std::string name = "varx";
        exchange_structure(io, stored.structure, name);
        io.field("parameters", stored.parameters, {"p"},
                 parameter_units(stored.structure, units.states(), units.inputs()));
        io.field("regressor_scale", stored.scale, {"r"});
        io.field("initial_variance", stored.variance, {"n_y"}, squared(units.states()));
        io.optional_field("noise_level", stored.level, {"n_y", "J"});
        io.optional_field("level_transition", stored.switching, {"J", "J"});
        io.optional_field("horizon", stored.horizon, {"H"}, {"samples"}, rule::between(2, 1e6));
        io.optional_field("horizon_factor", stored.factor, {"H"});
      });
  if constexpr (Io::reads)
    io.finish([&] {
      validate(bank);
      check_count("state_names", bank.state_names, bank.structure.dimension());
      check_count("input_names", bank.input_names, bank.structure.acting_inputs());
    });
}

}  // namespace modebank::layout
