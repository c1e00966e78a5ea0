#include <algorithm>
#include <cmath>

#include "io/csv/csv.hpp"
#include "io/simulation/simulation_writer.hpp"
#include "tests/io/import/import_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::uint64_t writer_seed = 3;

class VehicleWriter : public test::ImportFixture {
 protected:
  VehicleWriter() {
    layout = {folder.path() / "simulated", {"wz", "speed"}, {"velL", "velR"}};
    options.root = layout.folder.string();
    options.state = layout.states;
    options.input = layout.inputs;
    options.truth = {"true_wz", "true_speed"};
    simulation.runs = 2;
    simulation.commands.samples = 60;
    simulation.dt_s = 0.1;
    simulation.state_rate_hz = 50.0;
    simulation.measured = 2;
  }

  VehicleLayout layout;
  VehicleSimulationOptions simulation;
};

TEST_F(VehicleWriter, NamesEveryColumn) {
  write_simulation(simulate_vehicle(simulation, writer_seed), layout);
  EXPECT_THAT(read_csv_header(layout.folder / "pro_01.csv"),
              ElementsAre("time", "velL", "velR", "cmd_velL", "cmd_velR"));
  EXPECT_THAT(read_csv_header(layout.folder / "imu_01.csv"),
              ElementsAre("time", "wz", "speed", "true_wz", "true_speed", "true_vy", "true_velL", "true_velR", "x", "y",
                          "heading", "friction", "mode"));
}

TEST_F(VehicleWriter, ImportGivesTheSameSamples) {
  const std::vector<VehicleRun> runs = simulate_vehicle(simulation, writer_seed);
  write_simulation(runs, layout);
  const Recording recording = import().recording;
  ASSERT_EQ(recording.runs.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Trajectory& read = recording.runs[i];
    ASSERT_EQ(read.samples(), 60);
    EXPECT_EQ(read.role, runs[i].role);
    EXPECT_EQ(read.input, runs[i].wheel_speed);
    const auto every_fifth = Eigen::seqN(0, 60, 5);
    EXPECT_TRUE(test::near(read.state, runs[i].measured(Eigen::all, every_fifth), 1e-9));
    EXPECT_TRUE(test::near(read.truth, runs[i].truth(Eigen::seqN(0, 2), every_fifth), 1e-9));
  }
}

// The inputs' stamps are early by lag_s. If data.lag_s has the same value, it moves every set-point to its true time.
TEST_F(VehicleWriter, TheSameLagAtImportUndoesTheSimulatedOne) {
  for (const double lag_s : {0.34, -0.26}) {
    simulation.sensors.lag_s = lag_s;
    const std::vector<VehicleRun> runs = simulate_vehicle(simulation, writer_seed);
    write_simulation(runs, layout);
    options.lag_s = lag_s;
    options.input = {"cmd_velL", "cmd_velR"};
    const Trajectory read = import().recording.runs[0];
    ASSERT_GT(read.samples(), 50);
    for (Index k = 0; k < read.samples(); ++k) {
      const Index in_force = static_cast<Index>(std::floor(read.time_s(k) / 0.1 + 1e-6));
      EXPECT_EQ(read.input.col(k), runs[0].command.col(in_force)) << lag_s << " at " << read.time_s(k);
      const double position = read.time_s(k) * 50.0;
      const Index j = std::min<Index>(static_cast<Index>(position), runs[0].time_s.size() - 2);
      const double share = position - static_cast<double>(j);
      const double truth = (1.0 - share) * runs[0].truth(0, j) + share * runs[0].truth(0, j + 1);
      EXPECT_NEAR(read.truth(0, k), truth, 1e-9) << "truth stays with true time";
    }
  }
}

TEST_F(VehicleWriter, LayoutThatDoesNotFit) {
  const std::vector<VehicleRun> runs = simulate_vehicle(simulation, writer_seed);
  const auto error = [&](const VehicleLayout& wrong) {
    return test::message_of<ConfigurationError>([&] { write_simulation(runs, wrong); });
  };
  VehicleLayout wrong = layout;
  wrong.inputs = {"vel"};
  EXPECT_THAT(error(wrong), HasSubstr("2 inputs (left and right wheel speed)"));
  wrong = layout;
  wrong.states = {"wz"};
  EXPECT_THAT(error(wrong), HasSubstr("1 state names for 2 simulated states"));
  wrong = layout;
  wrong.states = {"wz", "mode"};
  EXPECT_THAT(error(wrong), HasSubstr("\"mode\" of column"));
  EXPECT_FALSE(std::filesystem::exists(layout.folder));
}

}  // namespace
}  // namespace modebank
