// Compares the CasADi module with the bank's own numbers. It is evaluated by CasADi, or by a stub if CasADi is missing.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "app/export/forms.hpp"
#include "tests/app/export/exported.hpp"
#include "tests/app/export/hostile_names.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::app::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using modebank::test::example_bank;
using nlohmann::json;

struct Point {
  VectorXd x, u, mu;
};

Point point_for(const Bank& bank) {
  const Index n = bank.structure.dimension(), m = bank.structure.acting_inputs(), K = bank.mode_count();
  VectorXd mu = VectorXd::LinSpaced(K, 1.0, 2.0);
  return {VectorXd::LinSpaced(n, 0.3, -0.2), VectorXd::LinSpaced(m, -0.4, 0.7), mu / mu.sum()};
}

json evaluated(const ExportedBank& exported, const Point& at) {
  const modebank::test::TemporaryFolder folder;
  const auto file = folder.path() / "bank.py";
  modebank::test::write_file(file, to_casadi(exported));
  const auto list = [](const VectorXd& v) { return json(std::vector<double>(v.begin(), v.end())).dump(); };
  const auto script = modebank::test::project_dir() / "tests/app/export/evaluate_casadi.py";
  const auto result = modebank::test::run_program(
      {"/usr/bin/python3", script.string(), file.string(), list(at.x), list(at.u), list(at.mu)});
  EXPECT_EQ(result.status, 0) << result.err;
  return result.status == 0 ? json::parse(result.out) : json();
}

MatrixXd matrix_of(const json& rows, Index cols) {
  MatrixXd M(static_cast<Index>(rows.size()), cols);
  for (Index i = 0; i < M.rows(); ++i)
    for (Index j = 0; j < cols; ++j) M(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return M;
}

/// The bank's expected state, and the mode probabilities after it.
std::pair<VectorXd, VectorXd> expected_step(const Bank& bank, const Point& at) {
  TransitionWorkspace workspace(bank.mode_count(), bank.transition_logit);
  const VectorXd nu =
      transition_at(bank.transition.matrix(), bank.transition_logit, at.x, at.u, workspace).transpose() * at.mu;
  VectorXd next = VectorXd::Zero(at.x.size());
  for (Index k = 0; k < bank.mode_count(); ++k)
    next += nu(k) * bank.modes[static_cast<std::size_t>(k)].model.next(at.x, at.u);
  return {next, nu};
}

void expect_same(const Bank& bank) {
  const Point at = point_for(bank);
  const Index n = at.x.size(), m = at.u.size(), K = bank.mode_count();
  const json said = evaluated(as_exported(bank), at);
  ASSERT_TRUE(said.is_object());
  const auto [next, nu] = expected_step(bank, at);
  EXPECT_LE((matrix_of(said["step"][0], 1) - next).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LE((matrix_of(said["step"][1], 1) - nu).cwiseAbs().maxCoeff(), 1e-9);
  const MatrixXd A = matrix_of(said["linearised"][0], n), B = matrix_of(said["linearised"][1], m),
                 c = matrix_of(said["linearised"][2], 1);
  EXPECT_LE((A * at.x + B * at.u + c - next).cwiseAbs().maxCoeff(), 1e-9);
  // The comparison is exact for a constant T. For state-dependent transition probabilities, it has the error of central
  // differences.
  const double step = 1e-5, tolerance = bank.transition_logit.empty() ? 1e-9 : 1e-7;
  for (Index j = 0; j < n + m; ++j) {
    Point up = at, down = at;
    (j < n ? up.x(j) : up.u(j - n)) += step;
    (j < n ? down.x(j) : down.u(j - n)) -= step;
    const VectorXd slope = (expected_step(bank, up).first - expected_step(bank, down).first) / (2.0 * step);
    EXPECT_LE((slope - (j < n ? A.col(j) : B.col(j - n))).cwiseAbs().maxCoeff(), tolerance) << j;
  }
  if (!bank.transition_logit.empty()) return;
  MatrixXd A_expected = MatrixXd::Zero(n, n);
  for (Index k = 0; k < K; ++k) A_expected += nu(k) * bank.modes[static_cast<std::size_t>(k)].model.full_form();
  EXPECT_LE((A - A_expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ExportedCasadi, StepsAndLinearises) {
  expect_same(example_bank(1, 2, 1));
  expect_same(example_bank(1, 1, 3));
  expect_same(example_bank(3, 2, 4));
}

TEST(ExportedCasadi, SwitchesByStateAndInput) {
  Bank bank = example_bank(2, 1, 3);
  bank.transition_logit.weights.resize(3, 3);
  bank.transition_logit.weights << 0.0, 0.0, 0.0, 2.0, -1.0, 3.0, -3.0, 1.0, 0.5;
  bank.transition_logit.reference = Eigen::Vector3d(0.1, -0.05, 0.2);
  expect_same(bank);
}

TEST(ExportedCasadi, NeedsNoInputs) {
  const Bank bank = example_bank(2, 0, 2);
  const Point at = point_for(bank);
  const json said = evaluated(as_exported(bank), at);
  EXPECT_LE((matrix_of(said["step"][0], 1) - expected_step(bank, at).first).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ExportedCasadi, HoldsHostileNames) {
  ExportedBank exported = as_exported(example_bank(1, 1, 2));
  for (const std::string& name : hostile_names()) {
    for (auto* channels : {&exported.states, &exported.inputs, &exported.measurements}) channels->at(0) = {name, name};
    exported.archive = exported.mode_names[0] = exported.provenance.modebank_version = name;
    const json said = evaluated(exported, point_for(exported.bank));
    ASSERT_TRUE(said.is_object()) << name;
    if (name.find('\xff') == std::string::npos) {
      EXPECT_EQ(said["states"][0], name);
    }
  }
}

}  // namespace
}  // namespace modebank::app::test
