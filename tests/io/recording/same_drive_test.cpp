#include <algorithm>
#include <memory>

#include "io/recording/recording_reader.hpp"
#include "io/recording/split_recording.hpp"
#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

/// A minute of the Husky's drive. python3-rosbag wrote the bag; writers in this folder wrote the MCAP and db3 files.
class SameDrive : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (shared_data_dir().empty() || !has_python_modules("rosbag, genpy")) return;
    folder_ = std::make_unique<TemporaryFolder>();
    run_recordings_script({"convert", (shared_data_dir() / "bags" / "husky_outdoor_test1.bag").string(), "0", "60",
                           folder_->path().string()});
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::filesystem::path file(const std::string& name) { return folder_->path() / name; }

  static inline std::unique_ptr<TemporaryFolder> folder_;
};

#define MODEBANK_NEEDS_DRIVE()  \
  MODEBANK_NEEDS_SHARED_DATA(); \
  MODEBANK_NEEDS_ROSBAG()

TEST_F(SameDrive, IsTheSameInEveryContainerAndCompression) {
  MODEBANK_NEEDS_DRIVE();
  const RosLog reference(file("drive_none.mcap"), KnownDefinitions());
  ASSERT_EQ(reference.topics().size(), 3u);
  for (const char* name : {"drive_lz4.mcap", "drive_zstd.mcap", "drive_no_summary.mcap", "drive_no_chunks.mcap",
                           "drive.db3", "drive_zstd.db3", "drive_split"}) {
    SCOPED_TRACE(name);
    const RosLog log(file(name), KnownDefinitions());
    EXPECT_TRUE(log.notes().empty());
    ASSERT_EQ(log.topics().size(), reference.topics().size());
    for (const LogTopic& topic : reference.topics())
      expect_same_topic(read_topic(reference, topic.name), read_topic(log, topic.name));
  }
}

TEST_F(SameDrive, IsTheSameAsRos1WritesIt) {
  MODEBANK_NEEDS_DRIVE();
  const RosLog reference(file("drive_none.mcap"), KnownDefinitions());
  for (const char* name : {"drive_none.bag", "drive_bz2.bag", "drive_lz4.bag", "drive_ros1.mcap"}) {
    SCOPED_TRACE(name);
    const RosLog log(file(name), KnownDefinitions());
    EXPECT_TRUE(log.notes().empty());
    for (const LogTopic& topic : reference.topics()) {
      WholeTopic ros1 = read_topic(log, topic.name);
      // Only ROS 1 has sequence numbers in headers.
      const auto seq = std::find_if(ros1.topic.columns.begin(), ros1.topic.columns.end(),
                                    [&](const MessageColumn& c) { return c.path == topic.name + ".header.seq"; });
      ASSERT_NE(seq, ros1.topic.columns.end());
      ros1.rows.columns.erase(ros1.rows.columns.begin() + (seq - ros1.topic.columns.begin()));
      ros1.topic.columns.erase(seq);
      expect_same_topic(read_topic(reference, topic.name), ros1);
    }
  }
}

/// The hash covers the messages that are read, and their definitions. It does not cover the container.
TEST_F(SameDrive, HasTheSameHashHoweverItIsStored) {
  MODEBANK_NEEDS_DRIVE();
  const auto hash = [](const std::string& name, const std::vector<std::string>& topics) {
    const RecordingReader reader(recording_files(file(name)), {});
    std::vector<TableRequest> requests;
    const std::vector<TableInfo> tables = reader.tables();
    for (std::size_t t = 0; t < tables.size(); ++t)
      if (std::find(topics.begin(), topics.end(), tables[t].name) != topics.end()) requests.push_back({t, {}});
    EXPECT_EQ(requests.size(), topics.size()) << name;
    return reader.describe(requests).sha256;
  };
  const std::vector<std::string> used{"/imu/data", "/fix"};
  for (const char* name : {"drive_lz4.mcap", "drive_zstd.mcap", "drive_no_summary.mcap", "drive_no_chunks.mcap",
                           "drive.db3", "drive_zstd.db3", "drive_split"})
    EXPECT_EQ(hash(name, used), hash("drive_none.mcap", used)) << name;
  for (const char* name : {"drive_bz2.bag", "drive_lz4.bag", "drive_ros1.mcap"})
    EXPECT_EQ(hash(name, used), hash("drive_none.bag", used)) << name;
  EXPECT_NE(hash("drive_none.bag", used), hash("drive_none.mcap", used));  // other payloads
  EXPECT_NE(hash("drive_none.bag", used), hash("drive_none.bag", {"/imu/data"}));
}

/// A truncated recording must give the first part of the whole recording.
TEST_F(SameDrive, CutOffGivesTheMessagesBefore) {
  MODEBANK_NEEDS_DRIVE();
  const TemporaryFolder cut;
  for (const char* name : {"drive_none.bag", "drive_bz2.bag", "drive_lz4.bag", "drive_none.mcap", "drive_lz4.mcap",
                           "drive_zstd.mcap", "drive_no_chunks.mcap"}) {
    SCOPED_TRACE(name);
    const RosLog whole(file(name), KnownDefinitions());
    const std::vector<double> all = read_column(whole, "/imu/data", "/imu/data.angular_velocity.y").numbers;
    const std::filesystem::path copy = cut.path() / name;
    std::filesystem::copy_file(file(name), copy);
    std::filesystem::resize_file(copy, std::filesystem::file_size(copy) / 2);
    const RosLog half(copy, KnownDefinitions());
    ASSERT_FALSE(half.notes().empty());
    EXPECT_THAT(half.notes().back(), ::testing::HasSubstr("damaged at byte"));
    const std::vector<double> some = read_column(half, "/imu/data", "/imu/data.angular_velocity.y").numbers;
    EXPECT_GT(some.size(), all.size() / 3);
    EXPECT_LT(some.size(), all.size() * 2 / 3);
    expect_same_bits(some, {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(some.size())}, name);
  }
}

/// A bag that was not closed has no index. Its header then contains 0 as the index position.
TEST_F(SameDrive, WithoutIndexIsReadWhole) {
  MODEBANK_NEEDS_DRIVE();
  const RosLog whole(file("drive_lz4.bag"), KnownDefinitions());
  const TemporaryFolder folder;
  const std::filesystem::path copy = folder.path() / "unindexed.bag";
  std::filesystem::copy_file(file("drive_lz4.bag"), copy);
  const ProgramResult blanked = run_program({python, "-c",
                                             "import sys, re; b = bytearray(open(sys.argv[1], 'rb').read()); i = "
                                             "b.index(b'index_pos=') + 10; b[i:i+8] = bytes(8); "
                                             "open(sys.argv[1], 'wb').write(b)",
                                             copy.string()});
  ASSERT_EQ(blanked.status, 0) << blanked.err;
  const RosLog log(copy, KnownDefinitions());
  ASSERT_EQ(log.notes().size(), 1u);
  EXPECT_THAT(log.notes().front(), ::testing::HasSubstr("index is missing or damaged"));
  for (const LogTopic& topic : whole.topics())
    expect_same_topic(read_topic(whole, topic.name), read_topic(log, topic.name));
}

}  // namespace modebank::test
