#include <gtest/gtest.h>

#include <cstdlib>

#include "io/csv/csv.hpp"
#include "io/files/read_file.hpp"
#include "io/import/import.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

constexpr double mean_tolerance = 1e-12;  // rounding error of sums of up to 1590 values below one, which may be added
                                          // in any order

DataOptions ice_options() {
  DataOptions options;
  options.root = test::shared_data_dir().string();
  options.inputs = "borealtc/ICE/pro_*.csv";
  options.states = "borealtc/ICE/imu_*.csv";
  options.state = {"wz"};
  options.input = {"velL", "velR"};
  return options;
}

TEST(ImportRealData, IceTransitions) {
  MODEBANK_NEEDS_SHARED_DATA();
  const ImportedData data = import_data(ice_options());
  EXPECT_EQ(data.recording.runs.size(), 12);
  EXPECT_EQ(data.files.size(), 24);
  EXPECT_EQ(data.recording.transitions(Role::train), 2636);  // method.md, section 7
  EXPECT_EQ(data.recording.transitions(Role::test), 2921);
  DataOptions swapped = ice_options();
  swapped.train = {"02", "04", "06", "08", "10", "12"};
  EXPECT_EQ(import_data(swapped).recording.transitions(Role::train), 2921);
}

TEST(ImportRealData, IceAgreesWithNumpy) {
  MODEBANK_NEEDS_SHARED_DATA();
  const std::string path = (test::golden_dir() / "ice_import.csv").string();
  const Table golden =
      parse_csv(path, read_file(path),
                {0, {"samples", "first", "last", "mean_wz", "mean_wz_squared", "mean_velL", "mean_velR"}, {"run"}});
  const Recording recording = import_data(ice_options()).recording;
  ASSERT_EQ(recording.runs.size(), golden.rows());
  for (std::size_t i = 0; i < golden.rows(); ++i) {
    const Trajectory& run = recording.runs[i];
    EXPECT_EQ(run.run, golden.texts.at(0)[i]);
    EXPECT_EQ(run.samples(), golden.numbers[0][i]);
    EXPECT_EQ(run.time_s(0), golden.numbers[1][i]);
    EXPECT_EQ(run.time_s(run.samples() - 1), golden.numbers[2][i]);
    EXPECT_NEAR(run.state.mean(), golden.numbers[3][i], mean_tolerance);
    EXPECT_NEAR(run.state.array().square().mean(), golden.numbers[4][i], mean_tolerance);
    EXPECT_NEAR(run.input.row(0).mean(), golden.numbers[5][i], mean_tolerance);
    EXPECT_NEAR(run.input.row(1).mean(), golden.numbers[6][i], mean_tolerance);
  }
}

TEST(ImportRealData, DriveBlocksAreRuns) {
  MODEBANK_NEEDS_SHARED_DATA();
  DataOptions options;
  options.root = test::shared_data_dir().string();
  options.inputs = "drive_husky/husky_samples.csv";
  options.state = {"gyro_z"};
  options.input = {"wheel_left", "wheel_right"};
  options.truth = {"icp_yawrate_fit"};
  options.time = {"t_block"};
  options.run = "block";
  const Recording recording = import_data(options).recording;
  ASSERT_EQ(recording.runs.size(), 201);   // the data's README: 201 blocks of 3 x 40 samples at 20 Hz
  EXPECT_EQ(recording.runs[2].run, "10");  // names in byte order: 0, 1, 10, 100, ...
  for (const Trajectory& run : recording.runs) {
    EXPECT_EQ(run.samples(), 120);
    EXPECT_EQ(run.truth.cols(), 120);
  }
}

}  // namespace
}  // namespace modebank
