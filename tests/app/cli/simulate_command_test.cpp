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
TEST_F(SimulateCommand, ShippedSimulationIsReadByItsOwnConfiguration) {
  const std::string config = (project_dir() / "configs/simulate_linear.ini").string(), folder = file("runs").string();
  const ProgramResult simulated =
      modebank({"simulate", config, "--simulate.output", folder, "--simulate.runs", "4", "--simulate.samples", "60"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const ProgramResult read =
      modebank({"run", config, "--until", "windows", "--data.root", folder, "--archive.output", archive()});
  ASSERT_EQ(read.status, 0) << read.err;
  EXPECT_EQ(read_archive(archive()).recording->runs.size(), 4u);
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
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal("modes = -0.3, -0.1, 0.1\nfriction = 0.1\n"),
              HasSubstr("own.ini:3: unknown key system.friction"));
  EXPECT_THAT(refusal("process_sd = -1\n"), HasSubstr(">= 0"));
  EXPECT_THAT(refusal("mode = 5\n"), HasSubstr("did you mean system.modes"));
  EXPECT_THAT(refusal("hold_samples = 5\nhold_samples = 6\n"),
              HasSubstr("own.ini:3: system.hold_samples is set twice"));
  EXPECT_THAT(refusal("process_sd = 0.1\n"), HasSubstr("system.modes is empty"));
  EXPECT_THAT(refusal("", "left, right", "car"), HasSubstr("expected three_grips, two_grounds or a file"));
  EXPECT_EQ(modebank({"simulate", file("sim.ini").string(), "--simulate.friction", "0.1"}).status, 2);
}

/// The files of systems equal the built-in ones, and state every parameter.
TEST_F(SimulateCommand, ShippedSystemsStateEveryParameter) {
  const auto made_by = [&](const std::string& system) {
    const std::string folder = file("made").string();
    std::filesystem::remove_all(file("made"));
    write("sim.ini", "[data]\nstate = wz\ninput = left, right\n[simulate]\nruns = 2\nsamples = 30\n" + system +
                         "output = " + folder + "\n");
    EXPECT_EQ(modebank({"simulate", file("sim.ini").string()}).status, 0);
    return read_file(std::filesystem::path(folder) / "imu_00.csv");
  };
  for (const char* name : {"three_grips", "two_grounds"}) {
    const std::string system = (project_dir() / "configs/systems" / (std::string(name) + ".ini")).string();
    EXPECT_EQ(made_by("system = " + std::string(name) + "\n"), made_by("system = " + system + "\n"));
    const std::string text = read_file(system);
    for (const app::Option& option : app::system_parameters())
      EXPECT_THAT(text, ::testing::ContainsRegex("\n" + option.name() + " *=")) << name;
  }
  EXPECT_EQ(made_by(""), made_by("system = two_grounds\n")) << "the default";
}

}  // namespace
}  // namespace modebank::test
