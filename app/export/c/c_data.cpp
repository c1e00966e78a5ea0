#include <fmt/format.h>

#include "app/export/c/c_parts.hpp"
#include "app/export/names.hpp"

namespace modebank::app::c_form {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// With all its digits, and never an integer's.
std::string number(double value) {
  std::string text = fmt::format("{:.17g}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "$F";
}

std::string row(const VectorXd& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + number(value);
  return "{" + (text.empty() ? number(0.0) : text) + "}";
}

std::string rows(const MatrixXd& M, const char* indent) {
  std::string text;
  for (Index i = 0; i < M.rows(); ++i)
    text += fmt::format("{}{}{}", i == 0 ? "{" : std::string(",\n ") + indent, row(M.row(i).transpose()), "");
  return text + "}";
}

std::string values_text(const MatrixXd& M) { return rows(M, "    "); }
std::string values_text(const VectorXd& v) { return row(v); }

std::string joined_names(const std::vector<Channel>& channels) {
  std::string text;
  for (const Channel& channel : channels)
    text += (text.empty() ? "" : ", ") + channel.name + (channel.unit.empty() ? "" : " [" + channel.unit + "]");
  return c_comment(text);
}

/// Of a comment; empty where nothing is known.
std::string errors_text(const MatrixXd& errors) {
  if (errors.size() == 0 || errors.array().isNaN().all()) return "not known";
  std::string text;
  for (Index i = 0; i < errors.rows(); ++i)
    for (Index j = 0; j < errors.cols(); ++j)
      text += fmt::format("{}{:.3g}", j > 0 ? " " : i > 0 ? "; " : "", errors(i, j));
  return text;
}

/// One matrix per mode, and standard errors of its entries.
template <class Get, class Errors>
std::string per_mode(const ExportedBank& bank, const std::string& declaration, const std::string& comment, Get get,
                     Errors errors) {
  std::string text = fmt::format("/* {} */\nstatic const $p_real {} = {{\n", comment, declaration);
  const Index K = bank.bank.mode_count();
  for (Index k = 0; k < K; ++k) {
    const auto at = static_cast<std::size_t>(k);
    text += fmt::format("    /* {}; standard errors {} */\n    {}{}\n", c_comment(bank.mode_names[at]),
                        errors_text(errors(at)), values_text(get(bank.bank.modes[at])), k + 1 < K ? "," : "");
  }
  return text + "};\n\n";
}

std::string vector_text(const std::string& declaration, const std::string& comment, const VectorXd& values) {
  return fmt::format("/* {} */\nstatic const $p_real {} = {};\n\n", comment, declaration, row(values));
}

std::string matrix_text(const std::string& declaration, const std::string& comment, const MatrixXd& values) {
  return fmt::format("/* {} */\nstatic const $p_real {} = {};\n\n", comment, declaration, rows(values, "   "));
}

}  // namespace

std::string data(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  std::string text = fmt::format(
      "/* The bank. x: {}.\n * u: {}.\n * y: {}.\n * A[i][j] is in units of x[i] per x[j], B[i][j] of x[i] per u[j], "
      "c[i] of x[i], Q[i][j] of x[i] x[j]. */\n\n",
      joined_names(exported.states), joined_names(exported.inputs), joined_names(exported.measurements));
  text += per_mode(
      exported, "bank_A[$P_MODES][$P_STATES][$P_STATES]", "A = I + the archive's increment",
      [](const Mode& mode) { return mode.model.full_form(); }, [&](std::size_t k) { return exported.errors[k].A; });
  if (bank.structure.acting_inputs() > 0)
    text += per_mode(
        exported, "bank_B[$P_MODES][$P_STATES][$P_ACTING_INPUTS]", "B", [](const Mode& mode) { return mode.model.B; },
        [&](std::size_t k) { return exported.errors[k].B; });
  text += per_mode(
      exported, "bank_c[$P_MODES][$P_STATES]", "c", [](const Mode& mode) { return mode.model.c; },
      [&](std::size_t k) { return exported.errors[k].c; });
  text += per_mode(
      exported, "bank_Q[$P_MODES][$P_STATES][$P_STATES]", "Q, per step of dt_s",
      [](const Mode& mode) { return mode.Q; }, [&](std::size_t k) { return bank.modes[k].Q_standard_error; });
  text += matrix_text("bank_C[$P_MEASUREMENTS][$P_STATES]", "C", bank.C);
  text += matrix_text("bank_R[$P_MEASUREMENTS][$P_MEASUREMENTS]", "R", bank.R);
  if (bank.mode_count() > 1)
    text += matrix_text("bank_T[$P_MODES][$P_MODES]", transition_meaning, bank.transition.matrix());
  text += vector_text("bank_initial_probability[$P_MODES]", "of the modes at a start", bank.initial_probability);
  if (!bank.transition_logit.empty()) {
    text += matrix_text("bank_logit_weight[$P_MODES][$P_STATES + $P_ACTING_INPUTS]",
                        "how x and u move the switches: T[i][j] is multiplied by exp(weight[j] . (z - reference)), z = "
                        "(x, u), and its rows are normalised",
                        bank.transition_logit.weights);
    text += vector_text("bank_logit_reference[$P_STATES + $P_ACTING_INPUTS]", "z where T holds",
                        bank.transition_logit.reference);
  }
  const StartMoments start = start_moments(bank);
  text += matrix_text("bank_start_gain[$P_STATES][$P_MEASUREMENTS * STATE_LAGS]",
                      "x of a start by the measurements, newest first", start.gain);
  return text + matrix_text("bank_start_covariance[$P_STATES][$P_STATES]", "and its covariance", start.covariance);
}

}  // namespace modebank::app::c_form
