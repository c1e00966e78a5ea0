// `modebank simulate`, and that `run` reads what it writes.
#include <gmock/gmock.h>

#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

class SimulateCommand : public CliTest {};

TEST_F(SimulateCommand, SimulateWritesRunsThatRunReads) {
  const std::string options =
      std::string("[data]\nstate = wz\ninput = left, right\n[simulate]\n") +
      "modes = -0.6, -0.7, 0.7 | -0.2, -0.1, 0.1\nprocess_sd = 0.01\nruns = 4\nsamples = 120\n" +
      "output = " + file("sim").string() + "\n";
  write("sim.ini", options);
  const ProgramResult simulated = modebank({"simulate", file("sim.ini").string()});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const ProgramResult result = run({"--data.root", file("sim").string(), "--data.inputs", "pro_*.csv", "--data.states",
                                    "imu_*.csv", "--data.truth", "true_wz"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive content = read_archive(archive());
  EXPECT_EQ(content.recording->runs.size(), 4u);
  EXPECT_EQ(content.recording->runs[0].samples(), 120);
  EXPECT_EQ(content.recording->runs[0].truth.cols(), 120);
}

/// The configuration that a simulation was made by reads it, too.
TEST_F(SimulateCommand, ShippedSimulationsAreReadByTheirOwnConfiguration) {
  for (const char* name : {"simulate_ice.ini", "simulate_linear.ini"}) {
    const std::string config = (project_dir() / "configs" / name).string(), folder = file(name).string() + ".runs";
    const ProgramResult simulated =
        modebank({"simulate", config, "--simulate.output", folder, "--simulate.runs", "4", "--simulate.samples", "60"});
    ASSERT_EQ(simulated.status, 0) << simulated.err;
    const ProgramResult read =
        modebank({"identify", config, "--data.root", folder, "--archive.output", file(name).string() + ".h5"});
    ASSERT_EQ(read.status, 0) << read.err;
    EXPECT_EQ(read_archive(file(name).string() + ".h5").recording->runs.size(), 4u);
  }
}

TEST_F(SimulateCommand, SimulatedVehicleRunsWithItsLagUndone) {
  const std::string folder = file("vehicle").string();
  write("vehicle.ini",
        "[data]\nstate = wz, vx\ninput = left, right\n[simulate]\nsystem = vehicle\nfriction = 0.06\nruns = 4\n"
        "samples = 120\nlag_s = 0.4\noutput = " +
            folder + "\n");
  const ProgramResult simulated = modebank({"simulate", file("vehicle.ini").string()});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const auto score = [&](const char* lag) {
    const ProgramResult result =
        run({"--data.root", folder, "--data.inputs", "pro_*.csv", "--data.states", "imu_*.csv", "--data.truth",
             "true_wz", "--data.input", "cmd_left, cmd_right", "--data.lag_s", lag});
    EXPECT_EQ(result.status, 0) << result.err;
    const Archive content = read_archive(archive());
    EXPECT_EQ(content.recording->runs.size(), 4u);
    EXPECT_EQ(content.recording->runs[0].truth.rows(), 1);
    return content.windows->global.noise_variance()(0);
  };
  const double undone = score("0.4");
  EXPECT_LT(undone, 0.8 * score("0"));
  EXPECT_LT(undone, 0.8 * score("-0.4"));
}

TEST_F(SimulateCommand, SimulateRefusesKeysOfTheOtherSystem) {
  const auto refusal = [&](const char* system, const char* key, const char* value) {
    write("sim.ini", "[data]\nstate = wz\ninput = left, right\n[simulate]\nsamples = 5\nsystem = " +
                         std::string(system) + "\noutput = " + file("sim").string() + "\n");
    const ProgramResult result = modebank({"simulate", file("sim.ini").string(), key, value});
    EXPECT_EQ(result.status, 2) << key;
    EXPECT_THAT(result.err, ::testing::HasSubstr(key + 2));
    EXPECT_FALSE(std::filesystem::exists(file("sim"))) << "nothing is written";
    return result.err;
  };
  EXPECT_THAT(refusal("vehicle", "--simulate.dwell_samples", "20"),
              ::testing::HasSubstr("belongs to simulate.system = linear"));
  refusal("linear", "--simulate.friction", "0.1, 0.5");
  refusal("vehicle", "--simulate.friction", "0");
  refusal("vehicle", "--simulate.drift", "0.9");
  refusal("vehicle", "--simulate.system", "car");
  write("three.ini", "[data]\nstate = wz\ninput = a, b, c\n[simulate]\nsystem = vehicle\n");
  const ProgramResult three = modebank({"simulate", file("three.ini").string()});
  EXPECT_EQ(three.status, 2);
  EXPECT_THAT(three.err, ::testing::HasSubstr("left and right wheel speed"));
}

}  // namespace
}  // namespace modebank::test
