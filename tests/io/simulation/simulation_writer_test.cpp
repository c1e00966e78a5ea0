#include "io/simulation/simulation_writer.hpp"

#include "ident/base/seed.hpp"
#include "io/csv/csv.hpp"
#include "io/csv/csv_head.hpp"
#include "io/files/read_file.hpp"
#include "io/simulation/simulation_files.hpp"
#include "tests/io/import/import_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A time is rounded when it is written. Interpolation then changes a value by the slope times this rounding error, in
// both directions.
constexpr double round_trip_tolerance = 1e-12;
constexpr double dt_s = 1.0 / 6.5;

/// Two states and two inputs: irregular signals whose numbers use all digits.
SimulatedRun make_run(Index samples, std::uint64_t index) {
  std::mt19937_64 generator = make_generator(7, "simulation_writer_test", index);
  const auto noise = [&](Index rows) {
    return Eigen::MatrixXd::NullaryExpr(rows, samples,
                                        [&] { return static_cast<double>(generator() >> 11) * 0x1p-52 - 1; });
  };
  SimulatedRun run;
  run.measured.time_s = Eigen::VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1)) * dt_s;
  run.measured.state = noise(2);
  run.measured.input = noise(2);
  run.measured.truth = noise(2);
  run.mode = Eigen::VectorXi::NullaryExpr(samples, [&] { return static_cast<int>(generator() % 3); });
  return run;
}

class SimulationWriter : public test::ImportFixture {
 protected:
  SimulationWriter() {
    layout.folder = folder.path() / "simulated";
    layout.states = {"wz", "vx"};
    layout.inputs = {"velL", "velR"};
    options.root = layout.folder.string();
    options.state = layout.states;
    options.input = layout.inputs;
    options.truth = {"true_wz", "true_vx"};
  }

  std::vector<std::string> files() const {
    std::vector<std::string> result;
    for (const auto& entry : std::filesystem::directory_iterator(layout.folder))
      result.push_back(entry.path().filename().string());
    std::sort(result.begin(), result.end());
    return result;
  }

  SimulationLayout layout;
};

TEST_F(SimulationWriter, ReadsBackAtMultiplesOfTheRate) {
  const std::vector<SimulatedRun> runs{make_run(200, 0), make_run(2, 1), make_run(57, 2)};
  for (const double multiple : {1.0, 2.0, 10.0, 64.0}) {
    layout.state_rate_hz = multiple / dt_s;
    write_simulation(runs, layout);
    const Recording recording = import().recording;
    ASSERT_EQ(recording.runs.size(), runs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const Trajectory &read = recording.runs[i], &written = runs[i].measured;
      EXPECT_EQ(read.time_s, written.time_s);
      EXPECT_TRUE(test::near(read.state, written.state, round_trip_tolerance)) << multiple;
      EXPECT_EQ(read.input, written.input);
      EXPECT_EQ(read.truth, written.truth);
    }
  }
}

TEST_F(SimulationWriter, KeepsAllSamplesAtOtherRates) {
  layout.state_rate_hz = 9.7;
  write_simulation({make_run(200, 0)}, layout);
  EXPECT_EQ(import().recording.runs[0].samples(), 200);
}

TEST_F(SimulationWriter, WritesModesAndExtendsTheStates) {
  const SimulatedRun run = make_run(20, 0);
  write_simulation({run}, layout);
  const Table pro = parse_csv("pro", read_file(layout.folder / "pro_00.csv"), {0, {"mode"}});
  ASSERT_EQ(pro.rows(), 20);
  for (Index k = 0; k < 20; ++k) EXPECT_EQ(pro.numbers[0][k], run.mode(k));
  const Table imu = parse_csv("imu", read_file(layout.folder / "imu_00.csv"), {0, {"time", "wz"}});
  EXPECT_GE(imu.numbers[0].back(), run.measured.time_s(19) + 1.0 / 65.0 - 1e-9);
  EXPECT_EQ(imu.numbers[1].back(), run.measured.state(0, 19)) << "held after the last sample";
}

TEST_F(SimulationWriter, FolderThatCannotBeMade) {
  const auto error = [&] {
    return test::message_of<ConfigurationError>([&] { write_simulation({make_run(3, 0)}, layout); });
  };
  layout.folder = folder.path() / "absent" / "simulated";
  EXPECT_THAT(error(), HasSubstr(layout.folder.string()));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "absent"));
  write("file", "");
  layout.folder = folder.path() / "file";
  EXPECT_THAT(error(), HasSubstr(layout.folder.string()));
}

TEST_F(SimulationWriter, AllFilesOrNone) {
  write_simulation({make_run(3, 0)}, layout);
  const std::string before = read_file(layout.folder / "imu_00.csv");
  std::filesystem::create_directory(layout.folder / "pro_01.csv");
  EXPECT_THAT(test::message_of<ConfigurationError>([&] {
                write_simulation({make_run(9, 1), make_run(9, 2)}, layout);
              }),
              HasSubstr("pro_01.csv"));
  EXPECT_THAT(files(), ElementsAre("imu_00.csv", "pro_00.csv", "pro_01.csv"));
  EXPECT_EQ(read_file(layout.folder / "imu_00.csv"), before);
}

TEST_F(SimulationWriter, RefusesToMixWithOtherRuns) {
  write_simulation({make_run(3, 0), make_run(3, 1)}, layout);
  test::write_file(layout.folder / "notes.txt", "not a run");
  EXPECT_THAT(test::message_of<ConfigurationError>([&] { write_simulation({make_run(3, 0)}, layout); }),
              HasSubstr("_01.csv"));
  EXPECT_NO_THROW(write_simulation({make_run(4, 0), make_run(4, 1)}, layout));
  EXPECT_EQ(import().recording.runs[1].samples(), 4);
}

TEST_F(SimulationWriter, ReplacesSimulatedRunsAlone) {
  const auto refuses = [&](const std::string& name, const std::string& mine) {
    const std::string before = read_file(layout.folder / name);
    test::write_file(layout.folder / name, mine);
    EXPECT_THAT(test::message_of<ConfigurationError>([&] { write_simulation({make_run(9, 1)}, layout); }),
                AllOf(HasSubstr("simulate.output: "), HasSubstr(name + " exists and is not replaced")));
    EXPECT_EQ(read_file(layout.folder / name), mine);
    test::write_file(layout.folder / name, before);
  };
  layout.states = {"wz,x", "vx"};  // a name that needs quotes
  write_simulation({make_run(3, 0)}, layout);
  for (const char* mine : {"precious", "time,left,right,mode\n0,1,2,3\n"}) refuses("pro_00.csv", mine);
  for (const char* mine : {"precious", "time,wz,vx,left\n0,1,2,3\n"}) refuses("imu_00.csv", mine);
  layout.inputs = {"throttle", "steering"};
  write_simulation({make_run(4, 0)}, layout);
  test::write_file(layout.folder / "pro_00.csv", "");  // an empty file may be replaced
  test::write_file(layout.folder / "imu_00.csv", "");
  write_simulation({make_run(4, 0)}, layout);
  std::filesystem::remove(layout.folder / "pro_00.csv");
  EXPECT_THAT(test::message_of<ConfigurationError>([&] { write_simulation({make_run(9, 1)}, layout); }),
              HasSubstr("imu_00.csv exists"))
      << "nothing shows that it is simulated";
}

TEST_F(SimulationWriter, LayoutThatDoesNotFit) {
  const auto error = [&](const SimulationLayout& wrong) {
    return test::message_of<ConfigurationError>([&] { write_simulation({make_run(3, 0)}, wrong); });
  };
  SimulationLayout wrong = layout;
  wrong.states = {"wz"};
  EXPECT_THAT(error(wrong), HasSubstr("1 state and 2 input names for 2 simulated states and 2 inputs"));
  wrong = layout;
  wrong.inputs = {"velL", "mode"};
  EXPECT_THAT(error(wrong), HasSubstr("\"mode\" of column"));
  wrong = layout;
  wrong.state_rate_hz = 0;
  EXPECT_THAT(error(wrong), HasSubstr("the rate of the simulated states is 0 Hz"));
  EXPECT_FALSE(std::filesystem::exists(layout.folder)) << "nothing is made for a layout that does not fit";
}

}  // namespace
}  // namespace modebank
