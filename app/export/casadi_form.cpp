#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "app/export/forms.hpp"
#include "app/export/names.hpp"

namespace modebank::app {
namespace {

using Eigen::MatrixXd;

/// The number as Python code. An unknown number becomes `nan`, which the module defines.
std::string python_number(double value) {
  return std::isnan(value) ? "nan" : std::isinf(value) ? (value > 0 ? "inf" : "-inf") : fmt::format("{:.17g}", value);
}

std::string python_matrix(const MatrixXd& M) {
  if (M.size() == 0) return fmt::format("ca.DM.zeros({}, {})", M.rows(), M.cols());
  std::string rows;
  for (Index i = 0; i < M.rows(); ++i) {
    std::string row;
    for (Index j = 0; j < M.cols(); ++j) row += (j > 0 ? ", " : "") + python_number(M(i, j));
    rows += (i > 0 ? ", [" : "[") + row + "]";
  }
  return "ca.DM([" + rows + "])";
}

template <class Get>
std::string python_per_mode(const char* name, const char* comment, Index modes, Get get) {
  std::string text = fmt::format("{}{} = (\n", *comment ? fmt::format("# {}\n", comment) : "", name);
  for (Index k = 0; k < modes; ++k) text += fmt::format("    {},\n", python_matrix(get(static_cast<std::size_t>(k))));
  return text + ")\n";
}

/// A Python tuple of texts. A tuple with one text needs a comma at its end.
std::string python_texts(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += quoted_scalar(text) + ", ";
  return "(" + list + ")";
}

std::string python_channels(const char* names, const char* units, const std::vector<Channel>& channels) {
  std::vector<std::string> all_names, all_units;
  for (const Channel& channel : channels) {
    all_names.push_back(channel.name);
    all_units.push_back(channel.unit);
  }
  return fmt::format("{} = {}\n{} = {}\n", names, python_texts(all_names), units, python_texts(all_units));
}

std::string python_opening(const ExportedBank& exported) {
  const LinearStructure& s = exported.structure();
  std::string remarks;
  for (const std::string& remark : exported.remarks()) remarks += "# " + comment_text(remark) + ".\n";
  return fmt::format(R"py(# Calibration: {}
# A bank of modes for CasADi, made by modebank {} of {},
# SHA-256 {}, filter {}.
# {}
# {}; its unit is 1.
# {} state lag(s), {} input lag(s), delay {} sample(s): x and u hold lagged samples as their names say.
{}import casadi as ca

nan = float("nan")

VERDICT = {}
REMARKS = {}
DT_S = {:.17g}  # a step takes [s]
INPUT_LAG_S = {:.17g}  # inputs act this much later [s]: at time t, u is what was recorded at t - INPUT_LAG_S
)py",
                     comment_text(exported.verdict_text()), comment_text(exported.provenance.modebank_version),
                     comment_text(exported.archive), exported.sha256, exported.filter, exported_equation,
                     transition_meaning, s.state_lags, s.input_lags, fmt::join(s.input_delay.listed(), ", "), remarks,
                     quoted_scalar(exported.verdict_text()), python_texts(exported.remarks()), exported.bank.dt_s,
                     exported.input_lag_s);
}

std::string python_bank(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  const Index K = bank.mode_count();
  const auto mode = [&](std::size_t k) -> const Mode& { return bank.modes[k]; };
  std::string text = python_channels("STATES", "STATE_UNITS", exported.states);
  text += python_channels("INPUTS", "INPUT_UNITS", exported.inputs);
  text += python_channels("MEASUREMENTS", "MEASUREMENT_UNITS", exported.measurements);
  text += fmt::format("MODES = {}\n", python_texts(exported.mode_names));
  std::vector<std::string> titles;
  for (const ModeFamily& family : exported.families) titles.push_back(family.title());
  text += fmt::format("FAMILIES = {}  # of modes, most used first\n\n", python_texts(titles));
  text += python_per_mode("A", "Units of x[i] per x[j]; A = I + the archive's increment.", K,
                          [&](std::size_t k) { return MatrixXd(mode(k).model.full_form()); });
  text += python_per_mode("B", "Units of x[i] per u[j].", K, [&](std::size_t k) { return mode(k).model.B; });
  text += python_per_mode("c", "Units of x[i].", K, [&](std::size_t k) { return MatrixXd(mode(k).model.c); });
  text += python_per_mode("Q", "Per step, units of x[i] x[j].", K, [&](std::size_t k) { return mode(k).Q; });
  text += python_per_mode("A_STANDARD_ERROR", "Standard errors of A, B, c and Q; nan: unknown.", K,
                          [&](std::size_t k) { return exported.errors[k].A; });
  text += python_per_mode("B_STANDARD_ERROR", "", K, [&](std::size_t k) { return exported.errors[k].B; });
  text +=
      python_per_mode("C_STANDARD_ERROR", "Of c.", K, [&](std::size_t k) { return MatrixXd(exported.errors[k].c); });
  if (bank.modes.front().Q_standard_error.size() > 0)
    text += python_per_mode("Q_STANDARD_ERROR", "", K, [&](std::size_t k) { return mode(k).Q_standard_error; });
  text += fmt::format("C = {}\nR = {}\n", python_matrix(bank.C), python_matrix(bank.R));
  text += fmt::format("T = {}\n", python_matrix(bank.transition.matrix()));
  if (bank.transition_standard_error.size() > 0)
    text += fmt::format("T_STANDARD_ERROR = {}\n", python_matrix(bank.transition_standard_error));
  text += fmt::format("INITIAL_PROBABILITY = {}\n", python_matrix(bank.initial_probability));
  if (bank.transition_logit.empty()) return text;
  return text + fmt::format(
                    "# Effect of z = (x, u) on switches: T[i][j] is multiplied by exp(W[j] (z - Z_REFERENCE)), then "
                    "rows are normalised.\nW = {}\nZ_REFERENCE = {}\n",
                    python_matrix(bank.transition_logit.weights), python_matrix(bank.transition_logit.reference));
}

constexpr const char* constant_transition = R"py(

def transition(x, u):
    """T of the step from x under u, K x K."""
    return T


def _transition_slopes(x, u, mu):
    """Derivatives of probabilities(x, u, mu) by (x, u), a row per mode: none."""
    return None
)py";

constexpr const char* logit_transition = R"py(

def transition(x, u):
    """T of the step from x under u, K x K."""
    odds = ca.mtimes(W, ca.vertcat(x, u) - Z_REFERENCE)
    factor = ca.exp(ca.fmax(odds - ca.mmax(odds), -200.0))
    weighted = T * ca.repmat(factor.T, len(MODES), 1)
    return weighted / ca.repmat(ca.sum2(weighted), 1, len(MODES))


def _transition_slopes(x, u, mu):
    """Derivatives of probabilities(x, u, mu) by (x, u), a row per mode."""
    at = transition(x, u)
    nu = ca.mtimes(at.T, mu)
    own = ca.repmat(nu, 1, W.shape[1]) * W
    return own - ca.mtimes(at.T, ca.repmat(mu, 1, W.shape[1]) * ca.mtimes(at, W))
)py";

constexpr const char* functions = R"py(

def mode_step(mode, x, u):
    """x[k+1] of one mode without noise."""
    return ca.mtimes(A[mode], x) + ca.mtimes(B[mode], u) + c[mode]


def probabilities(x, u, mu):
    """Probabilities of the modes in the step from x under u; mu: those of the previous step."""
    return ca.mtimes(transition(x, u).T, mu)


def step(x, u, mu):
    """The bank's expected value: (x[k+1], mu[k+1])."""
    nu = probabilities(x, u, mu)
    x_next = sum(nu[j] * mode_step(j, x, u) for j in range(len(MODES)))
    return x_next, nu


def linearised(x, u, mu):
    """(A, B, c) of x[k+1] = A x + B u + c about x and u, exact everywhere where T is constant."""
    nu = probabilities(x, u, mu)
    A_all = sum(nu[j] * A[j] for j in range(len(MODES)))
    B_all = sum(nu[j] * B[j] for j in range(len(MODES)))
    slopes = _transition_slopes(x, u, mu)
    if slopes is not None:
        for j in range(len(MODES)):
            here = mode_step(j, x, u)
            A_all = A_all + ca.mtimes(here, slopes[j, : len(STATES)])
            B_all = B_all + ca.mtimes(here, slopes[j, len(STATES) :])
    c_all = step(x, u, mu)[0] - ca.mtimes(A_all, x) - ca.mtimes(B_all, u)
    return A_all, B_all, c_all


def _symbols():
    return ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(INPUTS)), ca.SX.sym("mu", len(MODES))


def step_function():
    """ca.Function (x, u, mu) -> (x_next, mu_next)."""
    x, u, mu = _symbols()
    return ca.Function("step", [x, u, mu], list(step(x, u, mu)), ["x", "u", "mu"], ["x_next", "mu_next"])


def linearised_function():
    """ca.Function (x, u, mu) -> (A, B, c)."""
    x, u, mu = _symbols()
    return ca.Function("linearised", [x, u, mu], list(linearised(x, u, mu)), ["x", "u", "mu"], ["A", "B", "c"])
)py";

}  // namespace

std::string to_casadi(const ExportedBank& exported) {
  std::string remarks;
  for (const std::string& remark : exported.remarks()) remarks += "# " + comment_text(remark) + "\n";
  return python_opening(exported) + remarks + python_bank(exported) +
         (exported.bank.transition_logit.empty() ? constant_transition : logit_transition) + functions;
}

}  // namespace modebank::app
