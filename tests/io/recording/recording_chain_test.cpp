#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

/// The same drive must give the same run in any container.
TEST(RecordingChain, IsTheSameFromDataToEvaluation) {
  MODEBANK_NEEDS_SHARED_DATA();
  MODEBANK_NEEDS_ROSBAG();
  const TemporaryFolder folder;
  const std::string bag = (shared_data_dir() / "bags" / "husky_outdoor_test1.bag").string();
  for (const auto& [run, begin, end] : {std::tuple{"a", "0", "60"}, std::tuple{"b", "60", "120"}}) {
    std::filesystem::create_directory(folder.path() / run);
    run_recordings_script({"convert", bag, begin, end, (folder.path() / run).string()});
  }
  write_file(folder.path() / "husky.ini",
             "[data]\nstate = /imu/data.angular_velocity.y\n"
             "input = /husky_velocity_controller/odom.twist.twist.angular.z\n[mixture]\ncomponents = 1..2\n");
  std::vector<std::string> compared{"compare"};
  for (const char* form : {"drive_none.bag", "drive_bz2.bag", "drive_lz4.bag", "drive_none.mcap", "drive_lz4.mcap",
                           "drive_zstd.mcap", "drive_no_summary.mcap", "drive.db3", "drive_split"}) {
    compared.push_back((folder.path() / (std::string(form) + ".h5")).string());
    const ProgramResult result = run_program({MODEBANK_PROGRAM, "run", (folder.path() / "husky.ini").string(),
                                              "--data.root", folder.path().string(), "--data.inputs",
                                              std::string("*/") + form, "--archive.output", compared.back()});
    ASSERT_EQ(result.status, 0) << form << ": " << result.err;
  }
  run_recordings_script(compared);
}

}  // namespace modebank::test
