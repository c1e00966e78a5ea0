#include <charconv>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

namespace {

std::string husky() { return (shared_data_dir() / "bags" / "husky_outdoor_test1.bag").string(); }

/// A file of numbers with a header row.
std::map<std::string, std::vector<double>> read_numbers(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line, field;
  std::getline(file, line);
  std::vector<std::string> names;
  for (std::istringstream header(line); std::getline(header, field, ',');) names.push_back(field);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(file, line)) {
    std::istringstream row(line);
    for (const std::string& name : names) {
      std::getline(row, field, ',');
      columns[name].push_back(std::stod(field));
    }
  }
  return columns;
}

struct Extract {
  std::string file, topic;
  std::map<std::string, std::string> columns;  ///< the extract's columns, by the message's column
};

const std::vector<Extract> extracts{
    {"imu",
     "/imu/data",
     {{"qx", "orientation.x"},
      {"qy", "orientation.y"},
      {"qz", "orientation.z"},
      {"qw", "orientation.w"},
      {"wx", "angular_velocity.x"},
      {"wy", "angular_velocity.y"},
      {"wz", "angular_velocity.z"},
      {"ax", "linear_acceleration.x"},
      {"ay", "linear_acceleration.y"},
      {"az", "linear_acceleration.z"}}},
    {"odom",
     "/husky_velocity_controller/odom",
     {{"x", "pose.pose.position.x"},
      {"y", "pose.pose.position.y"},
      {"z", "pose.pose.position.z"},
      {"qx", "pose.pose.orientation.x"},
      {"qy", "pose.pose.orientation.y"},
      {"qz", "pose.pose.orientation.z"},
      {"qw", "pose.pose.orientation.w"},
      {"vx", "twist.twist.linear.x"},
      {"vy", "twist.twist.linear.y"},
      {"vz", "twist.twist.linear.z"},
      {"wx", "twist.twist.angular.x"},
      {"wy", "twist.twist.angular.y"},
      {"wz", "twist.twist.angular.z"}}},
    {"fix", "/fix", {{"status", "status.status"}, {"lat", "latitude"}, {"lon", "longitude"}, {"alt", "altitude"}}}};

}  // namespace

TEST(RealRecordings, TheHuskyBagHasTheNumbersOfItsExtracts) {
  MODEBANK_NEEDS_SHARED_DATA();
  const RosLog log(husky(), KnownDefinitions());
  EXPECT_TRUE(log.notes().empty());
  for (const Extract& extract : extracts) {
    const auto expected = read_numbers(shared_data_dir() / "bags" / ("husky_outdoor_test1_" + extract.file + ".csv"));
    const WholeTopic topic = read_topic(log, extract.topic);
    for (const auto& [name, field] : extract.columns) {
      const std::vector<double>& read = topic.column(field).numbers;
      ASSERT_EQ(read.size(), expected.at(name).size());
      // The values are printed with nine decimals.
      for (std::size_t k = 0; k < read.size(); ++k) ASSERT_NEAR(read[k], expected.at(name)[k], 0.5000001e-9) << field;
    }
    for (const auto& [name, field] : {std::pair{"t", "header.stamp"}, std::pair{"t_rec", "receive_time"}}) {
      const std::vector<std::int64_t>& read = topic.column(field).exact;
      ASSERT_EQ(read.size(), expected.at(name).size());
      // Stamps in the extract are doubles. Whole seconds and fractions are compared separately, so both are exact.
      for (std::size_t k = 0; k < read.size(); ++k)
        ASSERT_NEAR(static_cast<double>(read[k] % 1'000'000'000'000) / 1e9, std::fmod(expected.at(name)[k], 1000.0),
                    2.4e-7)
            << field;
    }
  }
}

TEST(RealRecordings, TheHuskyBagIsWhatRosbagReads) {
  MODEBANK_NEEDS_SHARED_DATA();
  MODEBANK_NEEDS_ROSBAG();
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "reference.json").string();
  run_recordings_script({"reference", husky(), out});
  std::ifstream file(out);
  const nlohmann::json reference = nlohmann::json::parse(file);
  const RosLog log(husky(), KnownDefinitions());
  ASSERT_EQ(log.topics().size(), reference.size());
  for (const LogTopic& topic : log.topics()) {
    const nlohmann::json& columns = reference.at(topic.name);
    EXPECT_EQ(topic.columns.size(), columns.size());
    LogRequest request{topic_position(log, topic.name), {}};
    for (const MessageColumn& column : topic.columns)
      request.columns.push_back(
          {column.path, column.form == MessageColumn::Form::text ? LogWant::Form::text : LogWant::Form::number});
    std::vector<std::string> notes;
    const LogRows rows = log.read({request}, notes).front();
    for (std::size_t i = 0; i < topic.columns.size(); ++i) {
      const nlohmann::json& expected = columns.at(topic.columns[i].path);
      if (topic.columns[i].form == MessageColumn::Form::text)
        EXPECT_EQ(rows.columns[i].text, expected.get<std::vector<std::string>>());
      else
        expect_same_bits(rows.columns[i].numbers, expected.get<std::vector<double>>(), topic.columns[i].path);
    }
  }
}

/// Both containers must have the same messages.
class BothContainers : public ::testing::TestWithParam<const char*> {};

TEST_P(BothContainers, Agree) {
  MODEBANK_NEEDS_SHARED_DATA();
  const std::filesystem::path folder = shared_data_dir() / "ros2";
  const RosLog mcap(folder / (std::string(GetParam()) + ".mcap"), KnownDefinitions());
  const RosLog db3(folder / (std::string(GetParam()) + ".db3"), KnownDefinitions());
  ASSERT_EQ(mcap.topics().size(), db3.topics().size());
  for (const LogTopic& topic : mcap.topics()) {
    EXPECT_EQ(topic.problem, "");
    expect_same_topic(read_topic(mcap, topic.name), read_topic(db3, topic.name));
  }
}

INSTANTIATE_TEST_SUITE_P(RealRecordings, BothContainers, ::testing::Values("cdr_test_0", "wbag_0", "talker"));

TEST(RealRecordings, EveryPrimitiveOfCdrHasItsValue) {
  MODEBANK_NEEDS_SHARED_DATA();
  const RosLog log(shared_data_dir() / "ros2" / "cdr_test_0.mcap", KnownDefinitions());
  const LogTopic& arrays = log.topics()[topic_position(log, "/array_topic")];
  EXPECT_EQ(arrays.messages, 4u);
  // The definition's default values are the values in the recorder's fixture: the largest and the smallest value of
  // each type.
  const auto values = [&](const std::string& field, std::size_t i) {
    return read_column(log, "/array_topic", "/array_topic." + field + "[" + std::to_string(i) + "]").numbers.front();
  };
  EXPECT_EQ(values("int16_values_default", 1), 32767.0);
  EXPECT_EQ(values("int16_values_default", 2), -32768.0);
  EXPECT_EQ(values("uint32_values_default", 2), 4294967295.0);
  EXPECT_EQ(values("float32_values_default", 0), 1.125);
  EXPECT_EQ(values("float64_values_default", 2), -3.1415);
  EXPECT_EQ(values("bool_values_default", 1), 1.0);
  const auto exact = [&](const std::string& field) {
    return read_column(log, "/array_topic", "/array_topic." + field, LogWant::Form::exact).exact.front();
  };
  EXPECT_EQ(exact("int64_values_default[1]"), 9223372036854775807);
  EXPECT_EQ(exact("int64_values_default[2]"), -9223372036854775807 - 1);
  EXPECT_EQ(read_column(log, "/array_topic", "/array_topic.uint64_values_default[2]", LogWant::Form::text).text.front(),
            "18446744073709551615");
  EXPECT_EQ(read_column(log, "/array_topic", "/array_topic.string_values_default[1]", LogWant::Form::text).text.front(),
            "max value");
}

TEST(RealRecordings, WhatADoubleDoesNotHoldIsSaid) {
  MODEBANK_NEEDS_SHARED_DATA();
  const RosLog log(shared_data_dir() / "ros2" / "cdr_test_0.mcap", KnownDefinitions());
  std::vector<std::string> notes;
  log.read({{topic_position(log, "/array_topic"), {{"/array_topic.int64_values_default[1]"}}}}, notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes.front(), ::testing::HasSubstr("4 values above 2^53"));
}

TEST(RealRecordings, TypesThatNobodyDefinesAreReadByAFolder) {
  MODEBANK_NEEDS_SHARED_DATA();
  // A copy of the recording from which the definitions were removed.
  const TemporaryFolder folder;
  const std::string copy = (folder.path() / "copy.db3").string();
  std::filesystem::copy_file(shared_data_dir() / "ros2" / "cdr_test_0.db3", copy);
  std::filesystem::permissions(copy, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
  const ProgramResult dropped = run_program({python, "-c",
                                             "import sqlite3, sys; d = sqlite3.connect(sys.argv[1]); d.execute('DELETE "
                                             "FROM message_definitions'); d.commit()",
                                             copy});
  ASSERT_EQ(dropped.status, 0) << dropped.err;
  const RosLog unknown(copy, KnownDefinitions());
  EXPECT_THAT(unknown.topics().front().problem, ::testing::HasSubstr("no definition of test_msgs/BasicTypes"));
  EXPECT_THAT(message_of<DataError>([&] { read_column(unknown, "/test_topic", "/test_topic.bool_value"); }),
              ::testing::HasSubstr("topic /test_topic (test_msgs/msg/BasicTypes) cannot be read"));
  const KnownDefinitions definitions(project_dir() / "tests" / "io" / "recording" / "definitions");
  const RosLog known(copy, definitions), original(shared_data_dir() / "ros2" / "cdr_test_0.mcap", KnownDefinitions());
  for (const char* topic : {"/test_topic", "/array_topic"})
    expect_same_topic(read_topic(known, topic), read_topic(original, topic));
}

}  // namespace modebank::test
