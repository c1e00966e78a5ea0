#include "io/recording/recording_reader.hpp"

#include "io/import/import.hpp"
#include "io/import/open_table.hpp"
#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

namespace {

using ::testing::HasSubstr;

DataOptions husky_options() {
  DataOptions options;
  options.inputs = options.states = "";
  options.root = (shared_data_dir() / "bags").string();
  options.inputs = "husky_outdoor_test1.bag";
  options.state = {"/imu/data.angular_velocity.y"};
  options.input = {"/husky_velocity_controller/odom.twist.twist.angular.z"};
  return options;
}

}  // namespace

TEST(RecordingReader, ATopicIsATableWithStamps) {
  MODEBANK_NEEDS_SHARED_DATA();
  const auto reader = open_table(shared_data_dir() / "bags" / "husky_outdoor_test1.bag", {});
  const std::vector<TableInfo> tables = reader->tables();
  ASSERT_EQ(tables.size(), 3u);
  EXPECT_EQ(tables[0].name, "/imu/data");
  EXPECT_EQ(tables[0].type, "sensor_msgs/Imu");
  EXPECT_EQ(tables[0].rows, 11865u);
  TableRequest imu{0, {"/imu/data.angular_velocity.y"}, {"/imu/data.header.frame_id"}, {}, {"/imu/data.header.stamp"}};
  TableRequest fix{2, {"/fix.latitude"}, {}, {}, {"/fix.receive_time"}};
  InputFile file;
  const std::vector<Table> read = reader->read({imu, fix}, &file);
  EXPECT_EQ(file.bytes, 1470835u);
  EXPECT_EQ(file.sha256.size(), 64u);
  EXPECT_EQ(reader->describe({imu, fix}).sha256, file.sha256);
  EXPECT_NE(reader->describe({imu}).sha256, file.sha256);
  ASSERT_EQ(read[0].rows(), 11865u);
  EXPECT_EQ(read[0].line.front(), 1u);
  EXPECT_EQ(read[0].time_ns.front(), 1432235497988949113);
  EXPECT_NEAR(read[0].numbers[0].front(), -0.010768941, 0.5e-9);
  EXPECT_EQ(read[0].texts.at(0).front(), "imu_link");
  ASSERT_EQ(read[1].rows(), 989u);
  EXPECT_EQ(read[1].time_ns.front(), 1432235498039331631);
}

TEST(RecordingReader, WhyAColumnIsMissingIsSaid) {
  MODEBANK_NEEDS_SHARED_DATA();
  DataOptions options = husky_options();
  options.state = {"/imu/data.angular_velocity.q"};
  EXPECT_THAT(message_of<ConfigurationError>([&] { import_data(options); }),
              HasSubstr("has no column \"/imu/data.angular_velocity.q\""));
}

}  // namespace modebank::test
