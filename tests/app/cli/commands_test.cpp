#include <fmt/format.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

class Commands : public CliTest {};

/// Data without noise: y[k+1] = 0.9 y[k] + 0.2 u[k], with all digits.
TEST_F(Commands, DataWithoutNoiseEndInCoefficients) {
  for (const char* name : {"run_00.csv", "run_01.csv"}) {
    std::string text = "time,y,u\n";
    double y = 0.3;
    for (int k = 0; k < 300; ++k) {
      const double u = std::sin(1.0 + k / 7 * (name[5] - '0' + 3.0));
      text += fmt::format("{:.17g},{:.17g},{:.17g}\n", 0.1 * k, y, u);
      y = 0.9 * y + 0.2 * u;
    }
    write(name, text);
  }
  write("exact.ini",
        "[data]\ninputs = run_*.csv\nstate = y\ninput = u\n[archive]\noutput = " + file("exact.h5").string() + "\n");
  const ProgramResult result = modebank({"run", file("exact.ini").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive archived = read_archive(file("exact.h5"));
  EXPECT_TRUE(archived.finding->without_noise);
  for (Eigen::Index mode = 0; mode < archived.bank->mode_count(); ++mode) {
    EXPECT_NEAR(archived.bank->theta(mode)(0), -0.1, 1e-12);
    EXPECT_NEAR(archived.bank->theta(mode)(1), 0.2, 1e-12);
  }
}

/// A first-order lag of 1 s with gain 2, discretised exactly for steps of 0.05 to 0.35 s. An earlier version found four
/// modes in these data.
TEST_F(Commands, StepsThatScatterEndInOneModelAndItsTimeConstant) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  boost::random::normal_distribution<double> normal;
  for (int run = 0; run < 8; ++run) {
    std::string text = "time,y,u\n";
    double t = 0.0, y = 0.0, u = 0.0;
    for (int k = 0; k < 400; ++k) {
      text += fmt::format("{:.6f},{:.6f},{:.4f}\n", t, y, u);
      const double dt = 0.05 + 0.3 * uniform(generator), a = std::exp(-dt);
      y = a * y + 2.0 * (1.0 - a) * u + 0.1 * std::sqrt((1.0 - a * a) / 2.0) * normal(generator);
      t += dt;
      if (uniform(generator) < 0.1) u = 2.0 * uniform(generator) - 1.0;
    }
    write(fmt::format("log_{}.csv", run), text);
  }
  write("uneven.ini",
        "[data]\ninputs = log_*.csv\nstate = y\ninput = u\n[archive]\noutput = " + file("uneven.h5").string() + "\n");
  const ProgramResult result = modebank({"run", file("uneven.ini").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive archived = read_archive(file("uneven.h5"));
  EXPECT_EQ(archived.finding->answer, Answer::not_yet);
  ASSERT_EQ(archived.bank->mode_count(), 1);
  EXPECT_NEAR(-archived.recording->median_period_s() / std::log1p(archived.bank->theta(0)(0)), 1.0, 0.1);
}

}  // namespace
}  // namespace modebank::test
