// Topics with reassigned connection numbers. The results are compared with those of other readers (topics.py).
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/import/import.hpp"
#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

ProgramResult topics_script(std::vector<std::string> arguments) {
  const std::string script = (project_dir() / "tests" / "io" / "recording" / "topics.py").string();
  arguments.insert(arguments.begin(), {python, "-B", script});
  return run_program(arguments);
}

class Topics : public ::testing::Test {
 protected:
  Topics() {
    const ProgramResult written = topics_script({"write", folder_.path().string()});
    EXPECT_EQ(written.status, 0) << written.err;
  }
  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }

  /// The messages of a file, as the other reader returns them.
  json reference(const std::filesystem::path& path) const {
    const ProgramResult read = topics_script({"read", path.string(), file("reference.json").string()});
    EXPECT_EQ(read.status, 0) << path << read.err;
    return json::parse(std::ifstream(file("reference.json")));
  }

  TemporaryFolder folder_;
};

/// Compares every topic, its stamps in nanoseconds, and the values of std_msgs/Float64.
void expect_reference(const RosLog& log, const json& reference, const std::string& name) {
  std::size_t with_messages = 0;
  for (const LogTopic& topic : log.topics()) with_messages += topic.messages > 0;
  EXPECT_EQ(with_messages, reference.size()) << name;
  for (const auto& [topic, messages] : reference.items()) {
    std::vector<std::int64_t> stamps;
    std::vector<double> values;
    for (const json& message : messages) {
      stamps.push_back(message[0].get<std::int64_t>());
      if (message[1].is_number()) values.push_back(message[1].get<double>());
    }
    EXPECT_EQ(read_column(log, topic, topic + ".receive_time", LogWant::Form::exact).exact, stamps) << name << topic;
    if (!values.empty()) {
      EXPECT_EQ(read_column(log, topic, topic + ".data").numbers, values) << name << topic;
    }
  }
}

/// The topic is in the header of the connection record. Only publishers in Python repeat the topic in the record's
/// data.
TEST_F(Topics, OfBagsAreThoseThatRosbagReads) {
  MODEBANK_NEEDS_ROSBAG();
  for (const char* name : {"header_only.bag", "repeated_in_data.bag", "remapped.bag"})
    expect_reference(RosLog(file(name), KnownDefinitions()), reference(file(name)), name);
  const json same = reference(file("header_only.bag"));  // rosbag cannot read a bag without the index
  ASSERT_EQ(same.at("/cmd").size(), 80u) << "of two publishers";
  ASSERT_EQ(same.at("/speed").size(), 60u);
  expect_reference(RosLog(file("no_index.bag"), KnownDefinitions()), same, "no_index.bag");
}

TEST_F(Topics, OfMcapAndDb3AreThoseOfTheirChannels) {
  for (const char* name : {"repeated.mcap", "repeated_loose.mcap", "repeated.db3"}) {
    const json expected = reference(file(name));
    EXPECT_EQ(expected.at("/cmd").size(), 80u);
    expect_reference(RosLog(file(name), KnownDefinitions()), expected, name);
  }
}

TEST_F(Topics, OfADb3WithItsJournalAreThoseOfBoth) {
  const json expected = reference(file("repeated.db3"));
  const RosLog log(file("killed.db3"), KnownDefinitions());
  for (int visit = 0; visit < 2; ++visit) expect_reference(log, expected, "killed.db3");
  std::filesystem::remove(file("killed.db3-wal"));
  EXPECT_THAT(message_of<DataError>([&] { RosLog(file("killed.db3"), KnownDefinitions()); }),
              HasSubstr("not a recording of rosbag2"));
}

/// From the record that reassigns a number, the number belongs to another channel. The summary does not change this.
TEST_F(Topics, AChannelsNumberMayBeGivenAgain) {
  for (const char* name : {"reused.mcap", "reused_no_summary.mcap", "reused_loose.mcap"}) {
    const json expected = reference(file(name));
    EXPECT_EQ(expected.at("/cmd").back().at(1), -14.75);
    const RosLog log(file(name), KnownDefinitions());
    for (int visit = 0; visit < 2; ++visit) expect_reference(log, expected, name);
  }
}

TEST_F(Topics, OfRealRecordingsAreThoseOfOtherReaders) {
  MODEBANK_NEEDS_SHARED_DATA();
  std::vector<std::filesystem::path> files;
  for (const char* name : {"talker.db3", "talker.mcap", "wbag_0.db3", "wbag_0.mcap"})
    files.push_back(shared_data_dir() / "ros2" / name);
  if (has_python_modules("rosbag, genpy")) files.push_back(shared_data_dir() / "bags" / "husky_outdoor_test1.bag");
  for (const std::filesystem::path& path : files)
    expect_reference(RosLog(path, KnownDefinitions()), reference(path), path.string());
}

TEST_F(Topics, ARecordingWithoutMessagesIsNamed) {
  const auto field = [](const std::string& text) {
    return std::string{static_cast<char>(text.size()), 0, 0, 0} + text;
  };
  const auto number = [](std::uint64_t value, std::size_t bytes) {
    std::string text;
    for (; bytes > 0; --bytes, value >>= 8) text += static_cast<char>(value & 0xff);
    return text;
  };
  for (const std::uint64_t index_at :
       {std::uint64_t{4117}, std::uint64_t{0}}) {  // a complete file, and a file that ends in the first second
    const std::string header = field("op=\x03") + field("index_pos=" + number(index_at, 8)) +
                               field("conn_count=" + number(0, 4)) + field("chunk_count=" + number(0, 4));
    const std::size_t padding = 4096 - header.size();
    write_file(file("empty.bag"),
               "#ROSBAG V2.0\n" + number(header.size(), 4) + header + number(padding, 4) + std::string(padding, ' '));
    EXPECT_THAT(message_of<DataError>([&] { RosLog(file("empty.bag"), KnownDefinitions()); }),
                HasSubstr("empty.bag: the recording has no messages"));
  }
  const std::string end("\x0f\x04\0\0\0\0\0\0\0\0\0\0\0\x02\x14\0\0\0\0\0\0\0", 22);
  write_file(file("empty.mcap"), "\x89MCAP0\r\n" + end + std::string(20, '\0') + "\x89MCAP0\r\n");
  EXPECT_THAT(message_of<DataError>([&] { RosLog(file("empty.mcap"), KnownDefinitions()); }),
              HasSubstr("empty.mcap: the recording has no messages"));
}

TEST_F(Topics, AlternatingFramesAreSaidWithTheKeyThatTakesThemApart) {
  DataOptions options;
  options.root = folder_.path().string();
  options.inputs = "tf.bag";
  options.state = {"/tf.transforms[0].transform.translation.x"};
  const std::string apart = "data.run = /tf.transforms[0].child_frame_id";
  EXPECT_THAT(import_data(options).notes, Contains(AllOf(HasSubstr("2 frames (base, arm)"), HasSubstr(apart))));
  options.run = "/tf.transforms[0].child_frame_id";
  const ImportedData data = import_data(options);
  EXPECT_THAT(data.notes, ::testing::Not(Contains(HasSubstr("alternate"))));
  ASSERT_EQ(data.recording.runs.size(), 2u);
  EXPECT_EQ(data.recording.runs[0].run, "arm");
  EXPECT_EQ(data.recording.runs[1].run, "base");
  ASSERT_EQ(data.recording.runs[0].samples(), 60);
  for (Index k = 0; k < 60; ++k) {
    ASSERT_EQ(data.recording.runs[0].state(0, k), -static_cast<double>(k) / 8.0);
    ASSERT_EQ(data.recording.runs[1].state(0, k), static_cast<double>(k) / 8.0);
  }
}

}  // namespace
}  // namespace modebank::test
