// Patterns in a bank's errors. For simulated errors, the gains are compared with closed forms.
#include "app/chain/error_pattern.hpp"

#include <gmock/gmock.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include "ident/base/distributions.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank {
namespace {

using Eigen::VectorXd;

double normal_probability(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// Training runs with one state and one input, and errors of a bank on these runs.
struct Drawn {
  Archive archive;
  FilterEvaluation bank{"bank", {}};

  /// `error(k, z, u, w)` returns the next error. It depends on earlier errors z, on the inputs u up to sample k, and on
  /// white noise w.
  Drawn(int runs, Index samples, const std::function<double(Index, const VectorXd&, const VectorXd&, double)>& error) {
    std::mt19937_64 generator(7);
    boost::random::normal_distribution<double> normal;
    archive.windows.emplace();
    archive.bank.emplace().model = "linear";
    archive.recording = Recording{{{"y", ""}}, {{"u", ""}}, {}, {}};
    for (int r = 0; r < runs; ++r) {
      Trajectory run;
      run.time_s = VectorXd::LinSpaced(samples, 0.0, 0.1 * static_cast<double>(samples - 1));
      run.state = Eigen::MatrixXd::Zero(1, samples);
      VectorXd u(samples), z(samples);
      for (Index k = 0; k < samples; ++k) {
        u(k) = normal(generator);
        z(k) = error(k, z, u, normal(generator));
      }
      run.input = 300.0 * u.transpose();  // the factor tests that the unit does not matter
      archive.recording->runs.push_back(run);
      RunEvaluation said;
      said.pit = z.unaryExpr(&normal_probability).transpose();
      said.pit(0, 0) = not_a_number;  // the filter has not started here
      bank.runs.push_back(said);
    }
  }
  ErrorPattern pattern() const { return error_pattern(archive, bank); }
};

double white(Index /*k*/, const VectorXd& /*z*/, const VectorXd& /*u*/, double w) { return w; }

TEST(ErrorPattern, WhiteErrorsHaveNone) {
  const ErrorPattern pattern = Drawn(6, 400, white).pattern();
  EXPECT_LT(pattern.gain, 0.0) << "coefficients of nothing cost";
  EXPECT_GT(pattern.gain, -0.02);
  EXPECT_FALSE(pattern.told());
}

/// With an autoregression of coefficient r, the errors' variance can decrease by the factor 1 - r^2. The gain is -ln(1
/// - r^2) / 2 nats per sample.
TEST(ErrorPattern, OfAnAutoregressionGainsWhatItsCoefficientSays) {
  for (const int runs : {6, 2}) {
    const ErrorPattern pattern = Drawn(runs, 2400 / runs, [](Index k, const VectorXd& z, const VectorXd&, double w) {
                                   return k == 0 ? w : 0.5 * z(k - 1) + std::sqrt(0.75) * w;
                                 }).pattern();
    EXPECT_NEAR(pattern.gain, -0.5 * std::log(0.75), 0.03) << runs << " runs";
    EXPECT_GT(pattern.standard_error, 0.0);
    EXPECT_TRUE(pattern.told());
  }
}

/// An unmodelled dead time makes white errors here: the inputs are drawn anew at each sample, so the errors have no
/// autocorrelation.
TEST(ErrorPattern, OfAnInputThatActsLateIsFound) {
  const ErrorPattern pattern = Drawn(6, 400, [](Index k, const VectorXd&, const VectorXd& u, double w) {
                                 return k < 5 ? w : 0.6 * u(k - 5) + 0.8 * w;
                               }).pattern();
  EXPECT_NEAR(pattern.gain, -std::log(0.8), 0.03);
  EXPECT_TRUE(pattern.told());
}

TEST(ErrorPattern, IsNotAskedForWhereLagsAreSettled) {
  Drawn drawn(6, 400, white);
  drawn.archive.structure.emplace();
  EXPECT_TRUE(std::isnan(drawn.pattern().gain)) << "searched for";
  drawn.archive.structure.reset();
  drawn.archive.bank->model = "slip";
  EXPECT_TRUE(std::isnan(drawn.pattern().gain)) << "a model without lags";
  drawn.archive.bank->model = "varx";
  EXPECT_FALSE(std::isnan(drawn.pattern().gain));
  drawn.archive.step_scatter = 0.3;
  EXPECT_TRUE(std::isnan(drawn.pattern().gain)) << "steps of many lengths";
  EXPECT_TRUE(std::isnan(Drawn(1, 90, white).pattern().gain)) << "too few samples";
}

using ErrorPatternOfRuns = test::CliTest;

/// A second-order motion that is fitted with one lag: y[k+1] = 1.1 y[k] - 0.4 y[k-1] + 0.2 u[k] + noise.
TEST_F(ErrorPatternOfRuns, OneLagTooFewEndsInTheKeyThatLooksForLags) {
  std::mt19937_64 generator(5);
  boost::random::normal_distribution<double> normal;
  for (int run = 0; run < 6; ++run) {
    std::ofstream log(file("log_" + std::to_string(run) + ".csv"));
    log << "time,y,u\n";
    double before = 0.0, y = 0.0, u = 0.0;
    for (int k = 0; k < 400; ++k) {
      if (k % 8 == 0) u = normal(generator);
      log << 0.1 * k << ',' << y << ',' << u << '\n';
      const double next = 1.1 * y - 0.4 * before + 0.2 * u + 0.02 * normal(generator);
      before = std::exchange(y, next);
    }
  }
  write("short.ini",
        "[data]\ninputs = log_*.csv\nstate = y\ninput = u\n[window]\nmodel = linear\n[bank]\nrefine = none\n"
        "[archive]\noutput = " +
            file("short.h5").string() + "\n");
  const test::ProgramResult result = modebank({"run", file("short.ini").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive stored = read_archive(file("short.h5"));
  EXPECT_TRUE(stored.finding->pattern.told()) << stored.finding->pattern.gain;
  EXPECT_TRUE(stored.finding->answer == Answer::not_yet || stored.finding->answer == Answer::one_mode) << result.out;
}

}  // namespace
}  // namespace modebank
