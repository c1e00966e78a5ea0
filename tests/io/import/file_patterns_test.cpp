#include "io/import/file_patterns.hpp"

#include "modebank/base/error.hpp"
#include "tests/io/import/expect_error.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class FilePatterns : public ::testing::Test {
 protected:
  void touch(const std::string& relative) const {
    fs::create_directories((folder.path() / relative).parent_path());
    test::write_file(folder.path() / relative, "x\n");
  }
  FilePattern pattern(const std::string& text) const { return {"data.inputs", folder.path().string(), text}; }
  std::vector<std::string> runs(const std::string& text) const { return pattern(text).runs(); }

  test::TemporaryFolder folder;
};

TEST_F(FilePatterns, NamesRunsByWhatTheStarMatchedInByteOrder) {
  for (const char* name : {"pro_10.csv", "pro_2.csv", "pro_B.csv", "pro_a.csv", "pro_.csv", "pro_1.txt", "imu_1.csv",
                           "xpro_1.csv", "pro_1.csv.bak"})
    touch(name);
  EXPECT_THAT(runs("pro_*.csv"), ElementsAre("10", "2", "B", "a"));
  EXPECT_EQ(pattern("pro_*.csv").path_of("10"), folder.path() / "pro_10.csv");
}

TEST_F(FilePatterns, OtherCharactersAreLiteral) {
  for (const char* name : {"a+(b)[c].1.csv", "aa(b)[c].2.csv", "a+(b)c.3.csv", "a+(b)[c]x4.csv"}) touch(name);
  EXPECT_THAT(runs("a+(b)[c].*.csv"), ElementsAre("1"));
}

TEST_F(FilePatterns, StarInAFolderName) {
  touch("day_1/pro.csv");
  touch("day_2/pro.csv");
  touch("day_3/other.csv");
  touch("night_1/pro.csv");
  EXPECT_THAT(runs("day_*/pro.csv"), ElementsAre("1", "2"));
  EXPECT_EQ(pattern("day_*/pro.csv").path_of("2"), folder.path() / "day_2" / "pro.csv");
}

TEST_F(FilePatterns, LeadingStarSkipsHiddenFiles) {
  touch("a.csv");
  touch("._a.csv");
  EXPECT_THAT(runs("*.csv"), ElementsAre("a"));
}

TEST_F(FilePatterns, RootMayHoldAStar) {
  touch("r*t/pro_1.csv");
  const FilePattern starred_root("data.inputs", (folder.path() / "r*t").string(), "pro_*.csv");
  EXPECT_THAT(starred_root.runs(), ElementsAre("1"));
}

TEST_F(FilePatterns, AbsolutePatternsIgnoreTheRoot) {
  touch("pro_1.csv");
  const FilePattern absolute("data.inputs", "/nowhere", (folder.path() / "pro_*.csv").string());
  EXPECT_THAT(absolute.runs(), ElementsAre("1"));
}

TEST_F(FilePatterns, WithoutStarTheStemNamesTheRun) {
  touch("drive.v2.csv");
  EXPECT_THAT(runs("sub/../drive.v2.csv"), ElementsAre("drive.v2"));
  EXPECT_FALSE(pattern("drive.v2.csv").has_star());
}

TEST_F(FilePatterns, NoMatchNamesTheAbsolutePattern) {
  touch("imu_1.csv");
  EXPECT_EQ(message_of<ConfigurationError>([&] { runs("pro_*.csv"); }),
            "data.inputs: no file matches " + (folder.path() / "pro_*.csv").string());
  EXPECT_EQ(message_of<ConfigurationError>([&] { runs("pro.csv"); }),
            "data.inputs: no file matches " + (folder.path() / "pro.csv").string());
}

TEST_F(FilePatterns, NoMatchNamesTheMissingFolder) {
  const std::string expected = "data.inputs: no file matches " + (folder.path() / "absent/deep/pro_*.csv").string() +
                               ": " + (folder.path() / "absent").string() + " does not exist";
  EXPECT_EQ(message_of<ConfigurationError>([&] { runs("absent/deep/pro_*.csv"); }), expected);
}

TEST_F(FilePatterns, AtMostOneStar) {
  EXPECT_THAT(message_of<ConfigurationError>([&] { pattern("*/pro_*.csv"); }),
              AllOf(HasSubstr("data.inputs = */pro_*.csv"), HasSubstr("2 stars")));
  EXPECT_EQ(message_of<ConfigurationError>([&] { pattern(""); }), "data.inputs is not set");
}

TEST_F(FilePatterns, Partners) {
  touch("pro_1.csv");
  touch("pro_2.csv");
  touch("imu_1.csv");
  const FilePattern inputs = pattern("pro_*.csv");
  const FilePattern states("data.states", folder.path().string(), "imu_*.csv");
  EXPECT_THAT(find_partners(inputs, states, {"1"}), ElementsAre(folder.path() / "imu_1.csv"));
  EXPECT_THAT(
      message_of<ConfigurationError>([&] {
        find_partners(inputs, states, {"1", "2"});
      }),
      AllOf(HasSubstr((folder.path() / "pro_2.csv").string()), HasSubstr((folder.path() / "imu_2.csv").string())));
}

TEST_F(FilePatterns, PartnersNeedTheSameStars) {
  const FilePattern states("data.states", folder.path().string(), "imu.csv");
  EXPECT_THAT(message_of<ConfigurationError>([&] { find_partners(pattern("pro_*.csv"), states, {"1"}); }),
              AllOf(HasSubstr("pro_*.csv"), HasSubstr("imu.csv"), HasSubstr("both or neither")));
}

/// Lists of files.
class ListedFiles : public FilePatterns {
 protected:
  RunFiles listed(const std::string& text, const char* key = "data.inputs") const {
    return {key, folder.path().string(), text};
  }
  std::vector<std::string> names(const std::string& text) const {
    std::vector<std::string> result;
    for (const RunFiles::File& file : listed(text).files()) result.push_back(file.run);
    return result;
  }
  std::string error(const std::string& text) const {
    return message_of<ConfigurationError>([&] { listed(text).files(); });
  }
};

TEST_F(ListedFiles, AreRunsByTheirStems) {
  for (const char* name : {"b.csv", "a.csv", "c.csv", "far/d.csv", "x, y.csv"}) touch(name);
  EXPECT_THAT(names("b.csv, a.csv,far/d.csv"), ElementsAre("a", "b", "d"));
  EXPECT_THAT(names("*.csv"), ElementsAre("a", "b", "c", "x, y"));
  EXPECT_THAT(names("x, y.csv"), ElementsAre("x, y")) << "it is there";
  EXPECT_FALSE(listed("a.csv, b.csv").one());
  EXPECT_TRUE(listed("a.csv").one());
}

TEST_F(ListedFiles, HavePartnersInTheSamePlace) {
  for (const char* name : {"u1.csv", "u2.csv", "y_b.csv", "y_a.csv"}) touch(name);
  const RunFiles inputs = listed("u2.csv, u1.csv"), states = listed("y_b.csv, y_a.csv", "data.states");
  const auto partners = states.partners(inputs, {"u1", "u2"});
  ASSERT_EQ(partners.size(), 2u);
  EXPECT_EQ(partners[0].path, folder.path() / "y_a.csv");
  EXPECT_EQ(partners[1].path, folder.path() / "y_b.csv");
  EXPECT_THAT(message_of<ConfigurationError>([&] {
                listed("y_a.csv", "data.states").partners(inputs, {"u1", "u2"});
              }),
              HasSubstr("data.inputs lists 2 files, but data.states lists 1"));
}

TEST_F(ListedFiles, SayWhatIsWrongWithAList) {
  touch("a.csv");
  touch("b/a.csv");
  EXPECT_THAT(error("a.csv, b*.csv"), HasSubstr("a list cannot contain a *"));
  EXPECT_THAT(error("a.csv,"), HasSubstr("an entry is empty"));
  EXPECT_THAT(error("a.csv, none.csv"), HasSubstr("none.csv"));
  EXPECT_THAT(error("a.csv, b/a.csv"), HasSubstr("would both have the run name a"));
}

}  // namespace
}  // namespace modebank
