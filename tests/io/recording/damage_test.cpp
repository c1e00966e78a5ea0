// Messages about damaged recordings. tests/fuzz covers other damage.
#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

namespace {

using ::testing::HasSubstr;

std::string error_of(const std::filesystem::path& path) {
  return message_of<DataError>([&] { RosLog(path, KnownDefinitions()); });
}

}  // namespace

TEST(DamagedRecordings, AreNamed) {
  const TemporaryFolder folder;
  const auto written = [&](const std::string& name, const std::string& content) {
    write_file(folder.path() / name, content);
    return folder.path() / name;
  };
  EXPECT_THAT(error_of(written("a.bag", "#ROSBAG V1.2\nabc")),
              HasSubstr("this bag has format 1.2, but only 2.0 is supported"));
  EXPECT_THAT(error_of(written("b.bag", "#ROSBAG V2.0\n")), HasSubstr("damaged at byte 13"));
  EXPECT_THAT(error_of(written("c.mcap", "\x89MCAP0\r\n")), HasSubstr("damaged at byte"));
  EXPECT_THAT(error_of(written("d.mcap", "time,x\n0,1\n")), HasSubstr("not a recording of ROS"));
  EXPECT_THAT(error_of(written("e.db3", std::string("SQLite format 3\0", 16) + "abc")), HasSubstr("SQLite: "));
  EXPECT_THAT(error_of(written("f.db3.zstd", "\x28\xb5\x2f\xfd abc")), HasSubstr("`zstd -d "));
  const std::string op{"op=\x03", 4}, encryptor = "encryptor=rosbag/AesCbcEncryptor";
  const auto field = [](const std::string& text) {
    return std::string{static_cast<char>(text.size()), 0, 0, 0} + text;
  };
  const std::string header = field(op) + field(encryptor);
  EXPECT_THAT(error_of(written("g.bag", "#ROSBAG V2.0\n" + field(header) + std::string(4, '\0'))),
              HasSubstr("encrypted (rosbag/AesCbcEncryptor)"));
}

/// Views of a malicious database could compute for ever or call any function.
TEST(DamagedRecordings, DatabasesOfOtherTablesAreRefused) {
  const TemporaryFolder folder;
  const auto database = [&](const std::string& name, const std::string& sql) {
    const std::string path = (folder.path() / name).string();
    const ProgramResult made = run_program(
        {python, "-c",
         "import sqlite3, sys; d = sqlite3.connect(sys.argv[1]); d.executescript(sys.argv[2]); d.commit()", path, sql});
    EXPECT_EQ(made.status, 0) << made.err;
    return path;
  };
  EXPECT_THAT(error_of(database("a.db3", "CREATE TABLE x(y)")),
              HasSubstr("not a recording of rosbag2 (it has no table topics)"));
  const std::string topics =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format, offered_qos_profiles);";
  EXPECT_THAT(error_of(database(
                  "b.db3", topics + "CREATE VIEW messages AS WITH RECURSIVE r(id) AS (SELECT 1 UNION ALL "
                                    "SELECT id + 1 FROM r) SELECT id, 1 topic_id, 0 timestamp, x'00' data FROM r")),
              HasSubstr("no table messages"));
}

TEST(SplitRecordings, AreListedByTheirFolder) {
  const TemporaryFolder folder;
  const auto error = [&] { return message_of<ConfigurationError>([&] { RosLog(folder.path(), KnownDefinitions()); }); };
  EXPECT_THAT(error(), HasSubstr("the folder has neither metadata.yaml nor .bag, .mcap or .db3 files"));
  write_file(folder.path() / "metadata.yaml", "a:\n  relative_file_paths:\n    - ../../etc/passwd\n");
  EXPECT_THAT(error(), HasSubstr("is not a file in its folder"));
}

}  // namespace modebank::test
