// `modebank simulate`, and `run` on the simulated files.
#include <gmock/gmock.h>

#include "app/config/options/sections.hpp"
#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

class SimulateCommand : public CliTest {};

/// The configuration of a simulation also works for `run` on the simulated runs.
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
  write("ice.ini", "[system]\nkind = vehicle\nfriction = 0.06\n");
  write("vehicle.ini",
        "[data]\nstate = wz, vx\ninput = left, right\n[simulate]\nsystem = ice.ini\nruns = 4\n"
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

TEST_F(SimulateCommand, RefusesWhatASystemDoesNotHave) {
  const auto refusal = [&](const std::string& lines, const std::string& input = "left, right",
                           const std::string& system = "own.ini") {
    write("own.ini", "[system]\n" + lines);
    write("sim.ini", "[data]\nstate = wz\ninput = " + input + "\n[simulate]\nsamples = 5\nsystem = " + system +
                         "\noutput = " + file("sim").string() + "\n");
    const ProgramResult result = modebank({"simulate", file("sim.ini").string()});
    EXPECT_EQ(result.status, 2) << lines;
    EXPECT_FALSE(std::filesystem::exists(file("sim"))) << "nothing is written";
    return result.err;
  };
  using ::testing::AllOf;
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal("kind = vehicle\ndwell_samples = 20\n"),
              AllOf(HasSubstr("own.ini:3"), HasSubstr("system.dwell_samples belongs to system.kind = linear")));
  EXPECT_THAT(refusal("kind = linear\nmodes = -0.3, -0.1, 0.1\nfriction = 0.1\n"), HasSubstr("system.friction"));
  EXPECT_THAT(refusal("kind = vehicle\nfriction = 0\n"), HasSubstr("> 0"));
  EXPECT_THAT(refusal("kind = vehicle\nmas = 5\n"), HasSubstr("did you mean system.mass"));
  EXPECT_THAT(refusal("kind = vehicle\nmass = 5\nmass = 6\n"), HasSubstr("own.ini:4: system.mass is set twice"));
  EXPECT_THAT(refusal("mass = 5\n"), HasSubstr("system.kind is not set"));
  EXPECT_THAT(refusal("kind = linear\n"), HasSubstr("system.modes is empty"));
  EXPECT_THAT(refusal("kind = car\n"), HasSubstr("linear | vehicle"));
  EXPECT_THAT(refusal("", "left, right", "car"), HasSubstr("expected husky_ice, three_grips, two_grounds or a file"));
  EXPECT_THAT(refusal("kind = vehicle\n", "a, b, c"), HasSubstr("left and right wheel speed"));
  EXPECT_EQ(modebank({"simulate", file("sim.ini").string(), "--simulate.friction", "0.1"}).status, 2);
  write("lag.ini", "[data]\nstate = wz\ninput = a, b\n[simulate]\nsystem = three_grips\nlag_s = 0.1\n");
  EXPECT_THAT(modebank({"simulate", file("lag.ini").string()}).err,
              HasSubstr("simulate.lag_s belongs to system.kind = vehicle, but three_grips is linear"));
}

/// The files of systems equal the built-in ones, and state every parameter that their kind of system has.
TEST_F(SimulateCommand, ShippedSystemsStateEveryParameter) {
  for (const char* name : {"husky_ice", "three_grips", "two_grounds"}) {
    const std::string system = (project_dir() / "configs/systems" / (std::string(name) + ".ini")).string();
    const auto made_by = [&](const std::string& which) {
      const std::string folder = file(which == name ? "own" : "of_file").string();
      write("sim.ini", "[data]\nstate = wz\ninput = left, right\n[simulate]\nruns = 2\nsamples = 30\nsystem = " +
                           which + "\noutput = " + folder + "\n");
      EXPECT_EQ(modebank({"simulate", file("sim.ini").string()}).status, 0);
      return read_file(std::filesystem::path(folder) / "imu_00.csv");
    };
    EXPECT_EQ(made_by(name), made_by(system));
    std::filesystem::remove_all(file("own"));
    std::filesystem::remove_all(file("of_file"));
    const std::string text = read_file(system);
    const bool vehicle = text.find("kind = vehicle") != std::string::npos;
    for (const app::Option& option : app::system_parameters()) {
      const bool of_it = !option.only_for || (*option.only_for == app::SimulatedSystem::vehicle) == vehicle;
      if (!of_it) continue;
      EXPECT_THAT(text, ::testing::ContainsRegex("\n" + option.name() + " *=")) << name;
    }
  }
}

}  // namespace
}  // namespace modebank::test
