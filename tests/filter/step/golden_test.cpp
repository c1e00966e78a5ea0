// The filters, compared with tests/golden/generate/imm_reference.py, an independent textbook implementation in numpy.
#include "tests/support/golden.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "modebank/judge/evaluate.hpp"
#include "tests/filter/public_bank.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using nlohmann::json;
using test::golden_columns;
using test::golden_rows;
using test::near;

/// Both implementations use double precision over 40 steps, with condition numbers below 1e3.
constexpr double tolerance = 1e-10;
/// The first covariances of the unobserved state are about ten. Their relative accuracy is the same.
constexpr double relative_tolerance = 1e-10;

Matrix golden_matrix(const json& rows) { return to_matrix(golden_rows(rows)); }

filter::Bank read_bank(const json& source) {
  filter::BankDescription bank;
  bank.C = golden_matrix(source.at("C"));
  bank.R = golden_matrix(source.at("R"));
  bank.transition = golden_matrix(source.at("T"));
  bank.initial_probability = source.at("pi").get<std::vector<double>>();
  for (const json& mode : source.at("modes")) {
    const auto c = mode.at("c").get<std::vector<double>>();
    bank.modes.push_back(
        {golden_matrix(mode.at("A")), golden_matrix(mode.at("B")), c, golden_matrix(mode.at("Q")), {}, 1.0});
  }
  bank.inputs = bank.modes[0].B.cols;
  bank.intercept = true;
  return filter::Bank(bank);
}

RecordedRun read_run(const json& measurement, const json& input) {
  RecordedRun run;
  run.state = to_matrix(golden_columns(measurement));
  run.input = to_matrix(golden_columns(input));
  for (std::ptrdiff_t k = 0; k < run.state.cols; ++k) run.time_s.push_back(static_cast<double>(k));
  return run;
}

class GoldenFilter : public testing::TestWithParam<const char*> {};

TEST_P(GoldenFilter, AgreesWithTheIndependentReference) {
  const json golden = test::read_golden(GetParam());
  const filter::Bank bank = read_bank(golden.at("bank"));
  const RecordedRun run = read_run(golden.at("measurement"), golden.at("input"));
  FilterOptions options;
  options.variant = parse_name<FilterVariant>(golden.at("variant").get<std::string>()).value();

  const judge::Evaluation actual = judge::evaluate_run(bank, run, options);

  const json& expected = golden.at("expected");
  const auto agrees = [&](const char* name, const Eigen::MatrixXd& value) {
    const Eigen::MatrixXd reference = golden_columns(expected.at(name));
    double scale = 1.0;
    for (const double entry : reference.reshaped())
      scale = std::isnan(entry) ? scale : std::max(scale, std::abs(entry));
    EXPECT_TRUE(near(value, reference, std::max(tolerance, relative_tolerance * scale))) << name;
  };
  agrees("prediction", view(actual.prediction));
  agrees("innovation", view(actual.innovation));
  agrees("innovation_covariance", view(actual.innovation_covariance));
  agrees("state", view(actual.state));
  agrees("covariance", view(actual.covariance));
  agrees("nis", view(actual.nis).transpose());
  agrees("pit", view(actual.pit));
  agrees("log_density", view(actual.log_density).transpose());
  agrees("predicted", test::predicted_probabilities(bank, run, options));
  agrees("mu", view(actual.mode_probability));
}

INSTANTIATE_TEST_SUITE_P(Cases, GoldenFilter,
                         testing::Values("imm_scalar", "imm_vector", "imm_partial", "imm_missing", "imm_three",
                                         "salvi2025_scalar", "salvi2025_vector"),
                         [](const auto& parameter) { return std::string(parameter.param); });

/// Banks of eight noise levels (tests/golden/generate/learn_reference.py).
TEST(GoldenLikelihood, OfModesThatShareTheta) {
  for (const json& of : test::read_golden("learn_noise_only")) {
    const Eigen::MatrixXd variances = golden_rows(of.at("variances")), R = golden_rows(of.at("R"));
    const Eigen::Index n = R.rows(), q = std::ssize(of.at("theta")) / n;
    const Eigen::MatrixXd theta = golden_rows(of.at("theta")).reshaped(q, n).transpose();
    filter::BankDescription bank;
    bank.inputs = q - n;
    bank.R = to_matrix(R);
    const Matrix A = to_matrix(theta.leftCols(n)), B = to_matrix(theta.rightCols(q - n));
    for (const auto& variance : variances.colwise())
      bank.modes.push_back({A, B, {}, to_matrix(variance.asDiagonal().toDenseMatrix()), {}, 1.0});
    for (std::size_t i = 0; i < of.at("stays").size(); ++i) {
      bank.transition = test::sticky_transition(variances.cols(), of.at("stays")[i].get<double>());
      double sum = 0.0;
      for (const json& run : of.at("runs"))
        sum += judge::log_likelihood(filter::Bank(bank), read_run(run.at("x"), run.at("u")));
      // tolerance for a sum over a hundred samples; each density agrees to 1e-10
      EXPECT_NEAR(sum, of.at("log_likelihood")[i].get<double>(), 1e-8);
    }
  }
}

}  // namespace
}  // namespace modebank
