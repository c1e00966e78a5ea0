#include "app/export/c/c_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "app/export/names.hpp"
#include "filter/step/bank.hpp"
#include "ident/model/linear_model.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::app::c_form {
namespace {

using Eigen::MatrixXd;

/// One enumerator per name, with its index and a comment.
std::string enumeration(const std::string& comment, const std::string& prefix, const std::vector<std::string>& names,
                        const std::vector<std::string>& remarks) {
  if (names.empty()) return "";
  std::string text = fmt::format("\n/* {} */\nenum {{\n", comment);
  for (std::size_t i = 0; i < names.size(); ++i)
    text += fmt::format("  {}_{} = {}{} /* {} */\n", prefix, names[i], i, i + 1 < names.size() ? "," : "",
                        comment_text(remarks[i]));
  return text + "};\n";
}

std::string places(const std::string& comment, const std::string& prefix, const std::vector<Channel>& channels) {
  std::vector<std::string> names, remarks;
  for (const Channel& channel : channels) {
    names.push_back(channel.name);
    remarks.push_back(channel.name + " [" + (channel.unit.empty() ? "unit not stated" : channel.unit) + "]");
  }
  return enumeration(comment, prefix, identifiers(names), remarks);
}

/// One enumerator per mode. The enumerator of a mode without a name contains the mode's number.
std::string modes(const ExportedBank& exported, const std::string& prefix) {
  std::vector<std::string> names = identifiers(exported.mode_names);
  for (std::size_t k = 0; k < names.size(); ++k)
    if (exported.mode_names[k] == fmt::format("mode {}", k)) names[k] = std::to_string(k);
  std::vector<std::string> remarks = exported.mode_names;
  for (const Motion& motion : exported.motions)
    for (const Index k : motion.modes)
      if (motion.modes.size() > 1) remarks[static_cast<std::size_t>(k)] += ", of the motion " + motion.title();
  return enumeration("Places in mode_probability", prefix, names, remarks);
}

/// A double with all digits. Whole numbers end in ".0".
std::string number(double value) {
  std::string text = fmt::format("{:.17g}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

/// Initializer such as {1.0, 2.0}. An empty vector becomes a single zero.
std::string row(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + number(value);
  return "{" + (text.empty() ? number(0.0) : text) + "}";
}

std::string values(const MatrixXd& M, const char* indent) {
  std::string text;
  for (Index i = 0; i < M.rows(); ++i)
    text += (text.empty() ? "{" : ",\n " + std::string(indent)) + row(M.row(i).transpose());
  return text + "}";
}

std::string constant(const std::string& name, const std::string& value, const std::string& comment) {
  return fmt::format("/* {} */\nstatic const double {} = {};\n\n", comment, name, value);
}

/// Standard errors as text for a comment. The text states which are unknown.
std::string errors_text(const MatrixXd& errors) {
  if (errors.size() == 0 || errors.array().isNaN().all()) return "not known";
  std::string text;
  for (Index i = 0; i < errors.rows(); ++i)
    for (Index j = 0; j < errors.cols(); ++j)
      text += fmt::format("{}{:.3g}", j > 0 ? " " : i > 0 ? "; " : "", errors(i, j));
  return text;
}

/// One value per mode, after a comment with the standard errors of these values.
template <class Value, class Errors>
std::string per_mode(const ExportedBank& bank, const std::string& name, const std::string& comment, Value value,
                     Errors errors) {
  std::string text;
  for (std::size_t k = 0; k < bank.mode_names.size(); ++k)
    text += fmt::format("{}    /* {}; standard errors {} */\n    {}", k > 0 ? ",\n" : "",
                        comment_text(bank.mode_names[k]), errors_text(errors(k)), value(bank.bank.modes[k]));
  return constant(name, "{\n" + text + "\n}", comment);
}

std::string model(const ExportedBank& exported) {
  return per_mode(
             exported, "bank_A[MODES][STATES][STATES]", "A = I + the archive's increment",
             [](const Mode& mode) { return values(mode.model.full_form(), "    "); },
             [&](std::size_t k) { return exported.errors[k].A; }) +
         per_mode(
             exported, "bank_B[MODES][STATES][ACTING_ROOM]", "B",
             [](const Mode& mode) { return values(mode.model.B, "    "); },
             [&](std::size_t k) { return exported.errors[k].B; }) +
         per_mode(
             exported, "bank_c[MODES][STATES]", "c", [](const Mode& mode) { return row(mode.model.c); },
             [&](std::size_t k) { return MatrixXd(exported.errors[k].c); }) +
         per_mode(
             exported, "bank_Q[MODES][STATES][STATES]", "Q, per step of bank_dt_s",
             [](const Mode& mode) { return values(mode.Q, "    "); },
             [&](std::size_t k) { return exported.bank.modes[k].Q_standard_error; });
}

std::string logit(const TransitionLogit& logit) {
  return constant("bank_logit_weight[MODES][STATES + ACTING_ROOM]",
                  logit.empty() ? "{{0.0}}" : values(logit.weights, "   "),
                  "with TRANSITION_BY_STATE T[i][j] is multiplied by exp(weight[j] . (z - reference)), z = (x, u), and "
                  "its rows are\n * normalised") +
         constant("bank_logit_reference[STATES + ACTING_ROOM]", logit.empty() ? "{0.0}" : row(logit.reference),
                  "z where T holds");
}

std::string joined_names(const std::vector<Channel>& channels) {
  std::string text;
  for (const Channel& channel : channels)
    text += (text.empty() ? "" : ", ") + channel.name + (channel.unit.empty() ? "" : " [" + channel.unit + "]");
  return comment_text(text);
}

}  // namespace

std::string bank_sizes(const ExportedBank& exported, const std::string& prefix) {
  const LinearStructure& s = exported.structure();
  return fmt::format(R"(enum {{
  {0}_MODES = {1},
  {0}_STATES = {2}, /* of x, lagged samples among them */
  {0}_MEASUREMENTS = {3}, /* of y */
  {0}_INPUTS = {4}, /* as they are recorded */
  {0}_ACTING_INPUTS = {5}, /* of u, which acts on one step: lagged samples among them */
  {0}_ROOM_FOR_INPUTS = {6},
  {0}_KEPT_INPUTS = {7}, /* samples that the filter remembers */
  {0}_KEPT_MEASUREMENTS = {8}
}};
)",
                     prefix, exported.bank.mode_count(), s.dimension(), exported.bank.C.rows(), s.inputs,
                     s.acting_inputs(), std::max<Index>(1, s.inputs), s.input_delay.latest() + s.input_lags,
                     s.state_lags) +
         places("Places in `input`", prefix + "_INPUT", exported.recorded_inputs) +
         places("Places in `measurement`", prefix + "_MEASUREMENT", exported.measurements) +
         places("Places in x", prefix + "_STATE", exported.states) + modes(exported, prefix + "_MODE");
}

std::string bank_numbers(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  const LinearStructure& s = bank.structure;
  const StartMoments start = start_moments(bank);
  std::string text =
      fmt::format(
          "/* The bank. x: {}.\n * u: {}.\n * y: {}.\n * A[i][j] is in units of x[i] per x[j], B[i][j] of x[i] per "
          "u[j], c[i] of x[i], Q[i][j] of x[i] x[j]. */\n"
          "enum {{\n  FIRST_TRANSITION = {}, /* of a run, by samples before it */\n"
          "  TRANSITION_BY_STATE = {}\n}};\n\n",
          joined_names(exported.states), joined_names(exported.inputs), joined_names(exported.measurements),
          exported.structure().first_transition(), bank.transition_logit.empty() ? 0 : 1) +
      constant("bank_dt_s", number(bank.dt_s), "Length of a step [s]; 0: samples have no clock") +
      fmt::format(
          "/* Samples from each input to its first effect */\nstatic const int bank_input_delay[] = {{{}}};\n\n",
          fmt::join(s.input_delay.by_input(std::max<Index>(1, s.inputs)), ", ")) +
      model(exported) + constant("bank_C[MEASUREMENTS][STATES]", values(bank.C, "   "), "C") +
      constant("bank_R[MEASUREMENTS][MEASUREMENTS]", values(bank.R, "   "), "R") +
      constant("bank_T[MODES][MODES]", values(bank.transition.matrix(), "   "), transition_meaning) +
      constant("bank_initial_probability[MODES]", row(bank.initial_probability), "of the modes at a start") +
      logit(bank.transition_logit) +
      constant("bank_start_gain[STATES][MEASUREMENTS * STATE_LAGS]", values(start.gain, "   "),
               "x of a start by the measurements, newest first") +
      constant("bank_start_covariance[STATES][STATES]", values(start.covariance, "   "), "and its covariance");
  text.pop_back();
  return text;
}

}  // namespace modebank::app::c_form
