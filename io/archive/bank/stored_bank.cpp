#include "io/archive/bank/stored_bank.hpp"

#include <algorithm>
#include <functional>

#include "modebank/base/error.hpp"

namespace modebank {

using Eigen::Index;

Eigen::MatrixXd one_of(const Eigen::MatrixXd& columns, Index k, Index rows, Index cols) {
  return columns.col(k).reshaped<Eigen::RowMajor>(rows, cols);
}

StoredChannels store_model_parameters(const std::vector<ModelParameter>& parameters) {
  StoredChannels stored;
  for (const ModelParameter& parameter : parameters) {
    stored.names.push_back(parameter.name);
    stored.units.push_back(parameter.unit);
  }
  return stored;
}

std::vector<ModelParameter> restore_model_parameters(const StoredChannels& stored) {
  if (stored.names.size() != stored.units.size())
    throw DataError("the numbers of parameter names and units must be equal");
  std::vector<ModelParameter> parameters;
  for (std::size_t i = 0; i < stored.names.size(); ++i) parameters.push_back({stored.names[i], stored.units[i]});
  return parameters;
}

void check_count(const std::string& what, const std::vector<std::string>& names, Index named) {
  if (names.empty() || std::ssize(names) == named) return;
  throw DataError(what + " holds " + std::to_string(names.size()) + " names for " + std::to_string(named));
}

void check_lags(const LinearStructure& s, Index dimension) {
  constexpr Index most_states = 1'000'000;  // upper limit, so that products of sizes do not overflow
  if (dimension < 1 || dimension > most_states || s.inputs < 0 || s.state_lags < 1 || s.input_lags < 1 ||
      s.input_delay.earliest() < 0 || !s.input_delay.fits(s.inputs) || dimension % s.state_lags != 0)
    throw DataError(std::to_string(dimension) + " states, " + std::to_string(s.inputs) + " inputs and lags of " +
                    std::to_string(s.state_lags) + ", " + std::to_string(s.input_lags) + ", " +
                    std::to_string(s.input_delay.latest()) + " are not possible");
}

[[noreturn]] void parameters_do_not_fit(Index parameters, Index states) {
  throw DataError(std::to_string(parameters) + " parameters do not fit " + std::to_string(states) + " states");
}

LinearStructure restore_structure(LinearStructure structure, Index dimension, Index parameters) {
  check_lags(structure, dimension);
  structure.states = dimension / structure.state_lags;
  if (structure.parameters() != parameters) parameters_do_not_fit(parameters, structure.states);
  return structure;
}

namespace {

/// Calls `visit` for every array of the modes. Its arguments are the member of StoredBank, the name in messages, rows,
/// columns, the member of a mode, and whether every bank has the array.
template <class Visit>
void for_each_mode_array(const LinearStructure& s, Index p_motion, Index terms, Visit visit) {
  const Index n = s.dimension(), p = s.parameters();
  const bool always = true, if_any = false;
  const auto of_model = [](auto matrix) {
    return [=](auto& mode) -> auto& { return mode.model.*matrix; };
  };
  visit(&StoredBank::c, "c", n, Index{1}, of_model(&LinearModel::c), always);
  visit(&StoredBank::A, "A", n, n, of_model(&LinearModel::A), always);
  visit(&StoredBank::B, "B", n, s.acting_inputs(), of_model(&LinearModel::B), always);
  visit(&StoredBank::Q, "Q", n, n, &Mode::Q, always);
  visit(&StoredBank::parameter_covariance, "parameter covariance", p, p, &Mode::parameter_covariance, if_any);
  visit(&StoredBank::standard_error, "parameter standard error", p, Index{1}, &Mode::standard_error, if_any);
  visit(&StoredBank::Q_standard_error, "Q standard error", n, n, &Mode::Q_standard_error, if_any);
  visit(&StoredBank::bend, "term coefficients", s.states, terms, &Mode::bend, if_any);
  visit(&StoredBank::bend_standard_error, "term coefficients standard error", s.states, terms,
        &Mode::bend_standard_error, if_any);
  const auto visit_response = [&](auto value, auto error, const char* what, auto number) {
    visit(
        value, what, s.states, s.inputs, [=](auto& mode) -> auto& { return mode.response.value.*number; }, if_any);
    visit(
        error, what, s.states, s.inputs, [=](auto& mode) -> auto& { return mode.response.error.*number; }, if_any);
  };
  visit_response(&StoredBank::steady_gain, &StoredBank::steady_gain_error, "steady gain", &StepResponse::gain);
  visit_response(&StoredBank::response_time_s, &StoredBank::response_time_error_s, "response time",
                 &StepResponse::response_s);
  visit_response(&StoredBank::settling_time_s, &StoredBank::settling_time_error_s, "settling time",
                 &StepResponse::settling_s);
  visit_response(&StoredBank::overshoot, &StoredBank::overshoot_error, "overshoot", &StepResponse::overshoot);
  visit_response(&StoredBank::largest_pole, &StoredBank::largest_pole_error, "largest pole", &StepResponse::radius);
  visit(
      &StoredBank::never_settles, "share that never settles", s.states, s.inputs,
      [](auto& mode) -> auto& { return mode.response.never_settles; }, if_any);
  if (p_motion == 0) return;
  visit(&StoredBank::motion_parameters, "motion parameters", p_motion, Index{1}, &Mode::motion_theta, always);
  visit(&StoredBank::motion_standard_error, "motion standard error", p_motion, Index{1}, &Mode::motion_standard_error,
        always);
}

/// Calls visit(member of StoredBank, member of the bank) for each matrix that belongs to the bank and not to a mode.
template <class Visit>
void for_each_bank_matrix(Visit visit) {
  visit(&StoredBank::C, &Bank::C);
  visit(&StoredBank::R, &Bank::R);
  visit(&StoredBank::R_standard_error, &Bank::R_standard_error);
  visit(&StoredBank::transition_standard_error, &Bank::transition_standard_error);
}

/// In the layout, weights may depend on the previous mode. In this version they are equal for all previous modes.
void store_logit(const Bank& bank, StoredBank& stored) {
  const TransitionLogit& logit = bank.transition_logit;
  if (logit.empty()) return;
  stored.transition_weights = side_by_side(
      bank.modes.size(), logit.weights.rows(), logit.weights.cols(),
      "transition weights", [&](std::size_t) -> const auto& { return logit.weights; });
  stored.transition_reference = logit.reference;
}

TransitionLogit restore_logit(const StoredBank& stored, Index modes) {
  const Eigen::MatrixXd& weights = stored.transition_weights;
  if (weights.size() == 0) {
    if (stored.transition_reference.size() > 0)
      throw DataError("there is a transition reference, but no transition weights");
    return {};
  }
  if (weights.rows() != modes * stored.transition_reference.size())
    throw DataError("transition weights and their reference differ in the number of features");
  if (weights != weights.col(0).replicate(1, weights.cols()))
    throw DataError("transition weights depend on the previous mode, which this version does not support");
  return {one_of(weights, 0, modes, stored.transition_reference.size()), stored.transition_reference};
}

constexpr Index most_factors = 3;

void store_terms(const MotionTerms& terms, StoredBank& stored) {
  if (terms.empty()) return;
  stored.term_variables.setConstant(most_factors, terms.count(), -1.0);
  stored.term_knots.resize(terms.count());
  for (Index t = 0; t < terms.count(); ++t) {
    const Term& term = terms.terms[static_cast<std::size_t>(t)];
    stored.term_kinds.emplace_back(name_of(term.kind));
    stored.term_knots(t) = term.knot;
    for (std::size_t i = 0; i < term.variables.size(); ++i)
      stored.term_variables(static_cast<Index>(i), t) = static_cast<double>(term.variables[i]);
  }
  stored.term_directions = terms.direction;
  stored.term_low = terms.low;
  stored.term_high = terms.high;
  stored.term_unit = terms.unit;
}

/// Wrong sizes are reported by check_terms.
MotionTerms restore_terms(const StoredBank& stored) {
  MotionTerms terms{stored.term_directions, stored.term_low, stored.term_high, stored.term_unit, {}};
  const Index T = std::ssize(stored.term_kinds);
  if (stored.term_knots.size() != T || stored.term_variables.cols() != T)
    throw DataError("the terms have " + std::to_string(T) + " kinds, " + std::to_string(stored.term_knots.size()) +
                    " knots and the variables of " + std::to_string(stored.term_variables.cols()));
  if (T > 0 && stored.bend.rows() != T * stored.structure.states)
    throw DataError("the terms have " + std::to_string(stored.bend.rows()) + " coefficients for " + std::to_string(T) +
                    " terms of " + std::to_string(stored.structure.states) + " states");
  for (Index t = 0; t < T; ++t) {
    const auto kind = parse_name<TermKind>(stored.term_kinds[static_cast<std::size_t>(t)]);
    if (!kind)
      throw DataError("unknown kind of term '" + stored.term_kinds[static_cast<std::size_t>(t)] +
                      "'; expected product, magnitude or hinge");
    Term term{*kind, {}, stored.term_knots(t)};
    for (const double variable : stored.term_variables.col(t)) {
      if (variable == -1.0) continue;
      if (!(variable >= 0.0 && variable < static_cast<double>(terms.variables())))
        throw DataError("term " + std::to_string(t) + " names a variable outside of the " +
                        std::to_string(terms.variables()));
      term.variables.push_back(static_cast<Index>(variable));
    }
    terms.terms.push_back(std::move(term));
  }
  return terms;
}

}  // namespace

StoredBank store_bank(const Bank& bank) {
  StoredBank stored;
  stored.model = bank.model;
  stored.structure = bank.structure;
  for_each_mode_array(bank.structure, std::ssize(bank.motion_parameters), bank.terms.count(),
                      [&](auto array, const char* what, Index rows, Index cols, auto of, bool always) {
                        const auto absent = [&](const Mode& mode) { return std::invoke(of, mode).size() == 0; };
                        if (!always && std::all_of(bank.modes.begin(), bank.modes.end(), absent)) return;
                        stored.*array = side_by_side(
                            bank.modes.size(), rows, cols,
                            what, [&](std::size_t k) -> const auto& { return std::invoke(of, bank.modes[k]); });
                      });
  stored.parameters.resize(bank.structure.parameters(), bank.mode_count());
  stored.weight.resize(bank.mode_count());
  for (Index k = 0; k < bank.mode_count(); ++k) {
    stored.parameters.col(k) = bank.theta(k);
    stored.weight(k) = bank.modes[static_cast<std::size_t>(k)].weight;
  }
  for_each_bank_matrix([&](auto array, auto matrix) { stored.*array = (bank.*matrix).transpose(); });
  stored.motion = Eigen::Map<const Eigen::VectorX<Index>>(bank.motion.data(), std::ssize(bank.motion)).cast<int>();
  stored.transition = bank.transition.matrix().transpose();
  store_logit(bank, stored);
  store_terms(bank.terms, stored);
  stored.quantum = bank.quantum;
  stored.initial_probability = bank.initial_probability;
  return stored;
}

Bank restore_bank(const StoredBank& stored, Bank bank) {
  const LinearStructure& s = stored.structure;
  const Index n = s.dimension(), p_motion = std::ssize(bank.motion_parameters);
  if (stored.B.rows() != n * s.acting_inputs())
    throw DataError("B has " + std::to_string(stored.B.rows() / n) + " inputs, the parameters " +
                    std::to_string(s.acting_inputs()));
  if (stored.motion_parameters.rows() != p_motion || stored.motion_standard_error.rows() != p_motion)
    throw DataError("the numbers of motion parameters and of their names differ");
  bank.model = stored.model;
  bank.structure = s;
  bank.terms = restore_terms(stored);
  bank.modes.assign(static_cast<std::size_t>(stored.weight.size()), Mode());
  for (Index k = 0; k < stored.weight.size(); ++k) {
    Mode& mode = bank.modes[static_cast<std::size_t>(k)];
    mode.weight = stored.weight(k);
    for_each_mode_array(s, p_motion, bank.terms.count(),
                        [&](auto array, const char*, Index rows, Index cols, auto of, bool always) {
                          if (always || (stored.*array).size() > 0)
                            std::invoke(of, mode) = one_of(stored.*array, k, rows, cols);
                        });
  }
  for_each_bank_matrix([&](auto array, auto matrix) { bank.*matrix = (stored.*array).transpose(); });
  bank.motion.assign(stored.motion.begin(), stored.motion.end());
  for (const int i : stored.motion)
    if (i > 0 && (stored.motion.array() != i - 1).all())
      throw DataError("no mode belongs to motion " + std::to_string(i - 1));
  bank.transition = TransitionMatrix(stored.transition.transpose());
  bank.transition_logit = restore_logit(stored, stored.weight.size());
  bank.quantum = stored.quantum;
  bank.initial_probability = stored.initial_probability;
  validate(bank);
  return bank;
}

StoredDrifting store_drifting(const Bank& bank) {
  const auto& factors = bank.running_noise.horizon_factor;
  StoredDrifting stored{bank.structure,
                        bank.theta(0),
                        bank.drift.scale,
                        bank.noise_variance(),
                        Eigen::VectorXd(factors.size()),
                        Eigen::VectorXd(factors.size()),
                        bank.running_noise.level.transpose(),
                        bank.running_noise.switching.transpose()};
  for (std::size_t i = 0; i < factors.size(); ++i) {
    stored.horizon(static_cast<Index>(i)) = static_cast<double>(factors[i].first);
    stored.factor(static_cast<Index>(i)) = factors[i].second;
  }
  return stored;
}

Bank restore_drifting(const StoredDrifting& stored, const Bank& rest) {
  const LinearStructure& s = stored.structure;
  check_lags(s, s.dimension());
  if (stored.parameters.size() != s.parameters()) parameters_do_not_fit(stored.parameters.size(), s.states);
  if (stored.variance.size() != s.states || stored.horizon.size() != stored.factor.size())
    throw DataError("its arrays differ in size");
  Bank bank = one_mode_bank(s, stored.parameters, stored.variance);
  bank.model = "varx";
  bank.state_names = rest.state_names;
  bank.input_names = rest.input_names;
  bank.dt_s = rest.dt_s;
  bank.quantum = rest.quantum;
  bank.drift = rest.drift;
  bank.drift.scale = stored.scale;
  bank.running_noise = rest.running_noise;
  bank.running_noise.level = stored.level.transpose();
  bank.running_noise.switching = stored.switching.transpose();
  for (Index i = 0; i < stored.horizon.size(); ++i)
    bank.running_noise.horizon_factor.emplace_back(static_cast<Index>(stored.horizon(i)), stored.factor(i));
  return bank;
}

}  // namespace modebank
