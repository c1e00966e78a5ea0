#pragma once

#include <string>

#include "ident/model/equations.hpp"
#include "ident/model/parameter_labels.hpp"
#include "io/archive/bank/stored_bank.hpp"
#include "io/archive/bank/units.hpp"
#include "io/archive/groups/columns.hpp"
#include "modebank/base/eigen.hpp"

/// The layout of banks; see io/archive/layout.hpp.
namespace modebank::layout {

/// Reads or writes a part that is a std::optional.
template <class Io, class T, class Body>
void exchange_part(Io& io, const std::string& name, T& part, const Sizes& known, Body body) {
  io.optional_group(name, part.has_value(), known, [&](auto& member) {
    if constexpr (Io::reads) part.emplace();
    body(member, *part);
  });
}

/// - input_delay: samples from each input to its first effect, one number per input
template <class Io, class D>
void exchange_delays(Io& io, D& delays, Eigen::Index inputs) {
  io.through(
      delays, [&](const InputDelays& of) { return of.by_input(inputs); },
      [](const std::vector<std::ptrdiff_t>& stored) { return InputDelays(stored); },
      [&](auto& stored) { io.attribute("input_delay", stored, rule::delay); });
}

/// The kind of the model. The number of states is not read here; restore_structure gets it from the arrays.
/// - model: `linear`, `varx` or the name of a motion model
/// - form: A and B predict the increment of the state
/// - intercept: 1: c is estimated
/// - inputs: number of input channels
/// - state_lags: samples of the state that predict the next one
/// - input_lags: samples of the input that act on one transition
/// - centre: means of states and inputs about which `parameters` are taken; `c` of a bank is not changed
template <class Io, class S, class Name>
void exchange_structure(Io& io, S& structure, Name& model) {
  io.attribute("model", model);
  io.constant_attribute("form", std::string("increment"));
  io.attribute("intercept", structure.intercept);
  io.attribute("inputs", structure.inputs, rule::channels);
  io.attribute("state_lags", structure.state_lags, rule::lags);
  io.attribute("input_lags", structure.input_lags, rule::lags);
  exchange_delays(io, structure.input_delay, structure.inputs);
  io.through(
      structure.centre, [](const std::vector<double>& of) { return Eigen::VectorXd(view(of)); },
      [](const Eigen::VectorXd& stored) { return to_vector(stored); },
      [&](auto& stored) { io.optional_field("centre", stored, {"channels"}, {}, rule::finite); });
}

/// Names and units of a motion model's parameters; empty lists for linear models.
template <class Io, class P>
void exchange_model_parameters(Io& io, P& parameters, const std::string& kind) {
  io.through(parameters, store_model_parameters, restore_model_parameters, [&](auto& stored) {
    io.attribute_texts(kind + "_names", stored.names);
    io.attribute_texts(kind + "_units", stored.units);
  });
}

/// Nonlinear terms of the motion. The letter V is the number of variables, T the number of terms.
/// - term_kinds: kind of each term: `product`, `magnitude` or `hinge`
/// - term_variables: positions of up to three variables; -1: none
/// - term_knots: knots of the terms, in units of the variable
/// - term_directions: variable = clip(direction' regressors, low, high) / unit
/// - term_low: lower bound of each variable
/// - term_high: upper bound of each variable
/// - term_unit: unit of each variable
/// - term_coefficients: coefficients of each mode
template <class Io, class S>
void exchange_terms(Io& io, S& stored) {
  io.optional_attribute_texts("term_kinds", stored.term_kinds);
  io.optional_field("term_variables", stored.term_variables, {"T", "factors"}, {}, rule::finite);
  io.optional_field("term_knots", stored.term_knots, {"T"}, {}, rule::finite);
  io.optional_field("term_directions", stored.term_directions, {"V", "regressors"}, {}, rule::finite);
  io.optional_field("term_low", stored.term_low, {"V"}, {}, rule::finite);
  io.optional_field("term_high", stored.term_high, {"V"}, {}, rule::finite);
  io.optional_field("term_unit", stored.term_unit, {"V"}, {}, rule::positive);
  io.optional_field("term_coefficients", stored.bend, {"K", "n_y", "T"}, {}, rule::finite);
  io.optional_field("term_coefficients_standard_error", stored.bend_standard_error, {"K", "n_y", "T"}, {});
}

/// The filter measures the recorded states. If there are equally many outputs and states, outputs have the states'
/// units.
/// - weight: mixture weight of each mode
/// - motion: numbers the motions; modes of one motion differ in noise. Absent: each mode is a motion of its own
/// - c: constant increment of the state
/// - A: x[k+1] = x[k] + A x[k] + B u[k] + c; n counts lagged states too
/// - B: matrix of the inputs; m counts lagged inputs too
/// - Q: process noise covariance of a step
/// - parameters: theta of each mode
/// - steady_gain: end of the response to a unit step of each input
/// - response_time_s: time to 63 % of that end, dead time included
/// - settling_time_s: time after which the state stays within 5 % of that end
/// - overshoot: by how much the peak exceeds that end, as a share of it
/// - largest_pole: largest modulus of the poles of that response, for all its pairs
/// - never_settles: share of the draws behind the errors of the response that have a pole beyond 1
/// - parameter_covariance: covariance of theta among the mode's windows
/// - C: y = C x
/// - R: measurement noise covariance
/// - quantum: step of the measured values; 0: continuous
/// - transition: row = from, column = to
/// - transition_weights: weights of the transition logit on features of state and input
/// - transition_reference: value of the features at which `transition` holds
/// - initial_probability: probability of each mode at the start of a run
/// - motion_parameters: parameters of a motion model
/// - motion_standard_error: standard errors of `motion_parameters`
template <class Io, class S>
void exchange_modes(Io& io, S& stored, const Unit& states, const Unit& inputs, const Unit& motion) {
  const Unit parameters = parameter_units(stored.structure, states, inputs);
  const bool measured = static_cast<std::size_t>(stored.C.cols()) == states.size();
  const Unit outputs(states.begin(), states.begin() + (measured ? stored.C.rows() : 0));
  io.field("weight", stored.weight, {"K"}, {}, rule::share);
  io.optional_field("motion", stored.motion, {"K"}, {}, rule::position("K"));
  io.field("c", stored.c, {"K", "n"}, states, rule::finite);
  io.field("A", stored.A, {"K", "n", "n"}, ratios(states, states), rule::finite);
  io.field("B", stored.B, {"K", "n", "m"}, ratios(states, inputs), rule::finite);
  io.field("Q", stored.Q, {"K", "n", "n"}, outer(states), rule::covariances);
  io.field("parameters", stored.parameters, {"K", "p"}, parameters, rule::finite_or_missing);
  io.optional_field("parameter_covariance", stored.parameter_covariance, {"K", "p", "p"}, outer(parameters));
  io.optional_field("parameter_standard_error", stored.standard_error, {"K", "p"}, parameters);
  io.optional_field("Q_standard_error", stored.Q_standard_error, {"K", "n", "n"}, outer(states));
  io.optional_field("R_standard_error", stored.R_standard_error, {"n_y", "n_y"}, measured ? outer(outputs) : Unit());
  io.optional_field("transition_standard_error", stored.transition_standard_error, {"K", "K"});
  io.field("C", stored.C, {"n_y", "n"}, measured ? ratios(outputs, states) : Unit(), rule::finite);
  io.field("R", stored.R, {"n_y", "n_y"}, measured ? outer(outputs) : Unit(), rule::covariances);
  io.optional_field("quantum", stored.quantum, {"n_y"}, outputs, rule::not_negative);
  if constexpr (!Io::reads) io.set_size("inputs", static_cast<std::size_t>(stored.structure.inputs));
  const Letters over_inputs{"K", "n_y", "inputs"};
  io.optional_field("steady_gain", stored.steady_gain, over_inputs);
  io.optional_field("steady_gain_standard_error", stored.steady_gain_error, over_inputs);
  io.optional_field("response_time_s", stored.response_time_s, over_inputs, {"s"});
  io.optional_field("response_time_s_standard_error", stored.response_time_error_s, over_inputs, {"s"});
  io.optional_field("settling_time_s", stored.settling_time_s, over_inputs, {"s"});
  io.optional_field("settling_time_s_standard_error", stored.settling_time_error_s, over_inputs, {"s"});
  io.optional_field("overshoot", stored.overshoot, over_inputs);
  io.optional_field("overshoot_standard_error", stored.overshoot_error, over_inputs);
  io.optional_field("largest_pole", stored.largest_pole, over_inputs);
  io.optional_field("largest_pole_standard_error", stored.largest_pole_error, over_inputs);
  io.optional_field("never_settles", stored.never_settles, over_inputs);
  io.field("transition", stored.transition, {"K", "K"}, {}, rule::probabilities);
  io.optional_field("transition_weights", stored.transition_weights, {"K", "K", "features"}, {}, rule::finite);
  io.optional_field("transition_reference", stored.transition_reference, {"features"}, {}, rule::finite);
  io.field("initial_probability", stored.initial_probability, {"K"}, {}, rule::probabilities);
  if constexpr (Io::reads)
    if (io.has("noise_weights"))
      throw DataError("the bank's noise follows state and input, which this version does not support; run again");
  exchange_terms(io, stored);
  io.optional_field("motion_parameters", stored.motion_parameters, {"K", "p_motion"}, motion, rule::finite);
  io.optional_field("motion_standard_error", stored.motion_standard_error, {"K", "p_motion"}, motion);
  exchange_structure(io, stored.structure, stored.model);
  if constexpr (Io::reads)
    io.finish([&] { stored.structure = restore_structure(stored.structure, io.size("n"), io.size("p")); });
}

/// Reads or writes names, period and screened modes, then all members of StoredBank.
/// - parameter_labels: output and regressor of each parameter, `wz <- velL`
/// - equations: lines of text, if the bank has nonlinear terms
/// - dt_s: period of a step [s]
/// - screened: components that did not become modes
/// - spectral_radius: spectral radius of I + A
template <class Io, class B>
void exchange_bank(Io& io, B& bank, const Units& units) {
  io.attribute_texts("state_names", bank.state_names);
  io.attribute_texts("input_names", bank.input_names);
  if constexpr (!Io::reads)
    io.attribute_texts("parameter_labels", parameter_labels(bank.structure, bank.state_names, bank.input_names));
  if constexpr (!Io::reads)
    if (!bank.terms.empty())
      io.attribute_texts("equations", equations(bank.structure, bank.modes.front().model, bank.terms,
                                                bank.modes.front().bend, bank.state_names, bank.input_names));
  io.attribute("dt_s", bank.dt_s, rule::positive);
  exchange_model_parameters(io, bank.motion_parameters, "motion_parameter");
  io.table("screened", bank.screened, column("component", &ScreenedMode::component),
           column("weight", &ScreenedMode::weight), column("spectral_radius", &ScreenedMode::spectral_radius),
           column("reason", &ScreenedMode::reason));
  const Unit states = units.states(bank.state_names), inputs = units.inputs(bank.input_names);
  io.through(
      bank, store_bank, [&](const StoredBank& stored) { return restore_bank(stored, bank); },
      [&](auto& stored) { exchange_modes(io, stored, states, inputs, unit_of(bank.motion_parameters)); });
  if constexpr (Io::reads)
    io.finish([&] {
      check_count("state_names", bank.state_names, bank.structure.dimension());
      check_count("input_names", bank.input_names, bank.structure.acting_inputs());
    });
}

}  // namespace modebank::layout
