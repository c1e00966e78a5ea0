#include "io/files/replace_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "modebank/base/error.hpp"
#include "tests/support/leftover.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(TemporaryFile, ItsNameSaysWhoseItIsAndWhatItWasToBecome) {
  for (const std::string target : {"k.h5", "a~b~1.tmp", "with blank.csv", ".hidden"}) {
    const fs::path path = temporary_path(fs::path("/some/where") / target);
    EXPECT_EQ(path.parent_path(), "/some/where");
    const auto name = parse_temporary_name(path.filename().string());
    ASSERT_TRUE(name.has_value()) << path;
    EXPECT_EQ(name->target, target);
    EXPECT_EQ(name->owner, this_process());
  }
  EXPECT_NE(temporary_path("k.h5"), temporary_path("k.h5"));
  EXPECT_LE(temporary_path(std::string(255, 'k')).string().size(), 255u);
  EXPECT_TRUE(parse_temporary_name(temporary_path(std::string(255, 'k')).string()).has_value());
}

TEST(TemporaryFile, OtherNamesAreNotTaken) {
  for (const char* name : {"", ".tmp", "..tmp", ".k.h5.1-0.tmp", "k.h5~h~b~1~2~3~4.tmp", ".k.h5~h~b~1~-2~3~4.tmp",
                           ".k.h5~h~b~1~0~3~4.tmp", ".k.h5~h~b~1~2~3~x.tmp", ".k.h5~h~b~1~2~3~4.tmp2", ".~~~~~~.tmp"})
    EXPECT_FALSE(parse_temporary_name(name).has_value()) << name;
}

TEST(TemporaryFile, OnlyAProcessOfThisMachineBootAndContainerIsJudged) {
  ProcessIdentity mine = this_process();
  EXPECT_EQ(state_of(mine), ProcessState::living);
  const auto changed = [&](auto change) {
    ProcessIdentity other = mine;
    change(other);
    return state_of(other);
  };
  EXPECT_EQ(changed([](auto& p) { p.host += "x"; }), ProcessState::unknown);
  EXPECT_EQ(changed([](auto& p) { p.boot = "0"; }), ProcessState::unknown);
  EXPECT_EQ(changed([](auto& p) { p.space += "1"; }), ProcessState::unknown);
  EXPECT_EQ(changed([](auto& p) { p.start_tick += 1; }), ProcessState::gone);  // the number was given again
  EXPECT_EQ(changed([](auto& p) { p.process = 2'000'000'000; }), ProcessState::gone);
}

TEST(Robustness, D16TheNextRunTakesAwayWhatAKilledOneLeft) {
  const TemporaryFolder folder;
  const fs::path left = leave_behind(folder.path() / "k.h5"), other_target = leave_behind(folder.path() / "x.csv");
  // What another machine, a living process or nobody of ours made stays.
  const std::string mine = temporary_path(folder.path() / "k.h5").filename().string();
  const fs::path living = folder.path() / mine,
                 foreign = folder.path() / ("." + std::string("k.h5~elsewhere~b~1~2~3~4.tmp")),
                 old = folder.path() / ".k.h5.1-0.tmp";
  for (const fs::path& path : {living, foreign, old}) std::ofstream(path) << "half";
  ASSERT_TRUE(fs::exists(left));
  replace_file(folder.path() / "k.h5", {"whole"});
  EXPECT_FALSE(fs::exists(left));
  EXPECT_FALSE(fs::exists(other_target));
  for (const fs::path& path : {living, foreign, old}) EXPECT_TRUE(fs::exists(path)) << path;
  EXPECT_EQ(text_of(folder.path() / "k.h5"), "whole");
}

TEST(Robustness, D16SymbolicLinksAreWrittenThrough) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "far");
  fs::create_symlink("far/target.h5", folder.path() / "relative");
  fs::create_symlink(folder.path() / "relative", folder.path() / "absolute");
  for (const char* text : {"made", "replaced"}) {  // the first where the link dangles
    replace_file(folder.path() / "absolute", {text});
    EXPECT_EQ(text_of(folder.path() / "far/target.h5"), text);
    EXPECT_TRUE(fs::is_symlink(folder.path() / "absolute"));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "relative"));
  }
  EXPECT_EQ(entries(folder.path()), 3u);
  EXPECT_EQ(entries(folder.path() / "far"), 1u);
}

TEST(Robustness, D16ALinkToItselfOrToADeviceIsRefused) {
  const TemporaryFolder folder;
  const fs::path loop = folder.path() / "loop", device = folder.path() / "device";
  fs::create_symlink("loop", loop);
  fs::create_symlink("/dev/full", device);
  EXPECT_THAT(write_obstacle(loop), HasSubstr("leads back to itself"));
  EXPECT_THAT(write_obstacle(device), HasSubstr("not a regular file"));
  EXPECT_THAT([&] { replace_file(loop, {"x"}); }, ThrowsMessage<DataError>(HasSubstr("leads back to itself")));
}

}  // namespace
}  // namespace modebank::test
