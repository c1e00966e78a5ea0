#include "io/files/replace_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "io/files/output_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"
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

/// Creates the temporary file of a process that was killed two days ago, and returns its path.
fs::path leave_behind(const fs::path& target) {
  const fs::path path = temporary_path(target);
  std::ofstream(path) << "half";
  fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(48));
  return path;
}

TEST(TemporaryFile, StandsBesideItsTargetUnderANewName) {
  for (const std::string target : {"k.h5", "with blank.csv", ".hidden"}) {
    const fs::path path = temporary_path(fs::path("/some/where") / target);
    EXPECT_EQ(path.parent_path(), "/some/where");
    EXPECT_THAT(path.filename().string(), testing::MatchesRegex("\\." + target + "\\.modebank-[0-9a-f]+\\.tmp"));
  }
  EXPECT_NE(temporary_path("k.h5"), temporary_path("k.h5"));
  EXPECT_EQ(temporary_path(std::string(255, 'k')).string().size(), 255u);
}

TEST(Robustness, D16TheNextRunTakesAwayWhatAKilledOneLeft) {
  const TemporaryFolder folder;
  const fs::path left = leave_behind(folder.path() / "k.h5"), other_target = leave_behind(folder.path() / "x.csv");
  // A file that is being written must stay. A file with another name must stay, too.
  const fs::path living = temporary_path(folder.path() / "k.h5"), old = folder.path() / ".k.h5.1-0.tmp",
                 other = folder.path() / ".k.modebank-0123456789ag.tmp";
  for (const fs::path& path : {living, old, other}) std::ofstream(path) << "half";
  for (const fs::path& path : {old, other})
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(48));
  ASSERT_TRUE(is_leftover(left));
  replace_file(folder.path() / "k.h5", {"whole"});
  EXPECT_FALSE(fs::exists(left));
  EXPECT_FALSE(fs::exists(other_target));
  for (const fs::path& path : {living, old, other}) EXPECT_TRUE(fs::exists(path)) << path;
  EXPECT_EQ(text_of(folder.path() / "k.h5"), "whole");
}

/// If the process is killed between any two writes, the target is either absent or complete.
TEST(Robustness, AKilledWriterLeavesTheTargetAsItWas) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "k.h5";
  for (const std::string before : {"", "old"}) {
    if (!before.empty()) replace_file(target, {before});
    const pid_t child = ::fork();
    if (child == 0)
      replace_file(target, [](const fs::path& temporary) {
        std::ofstream(temporary) << "half";
        ::raise(SIGKILL);
      });
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(fs::exists(target), !before.empty());
    EXPECT_EQ(text_of(target), before);
  }
}

TEST(Robustness, D16SymbolicLinksThatAUserNamesAreWrittenThrough) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "far");
  fs::create_symlink("far/target.h5", folder.path() / "relative");
  fs::create_symlink(folder.path() / "relative", folder.path() / "absolute");
  for (const char* text : {"made", "replaced"}) {  // at first the link's target does not exist
    replace_file(final_target(folder.path() / "absolute"), {text});
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
  const FileForm any{"a file", [](const fs::path&) { return true; }};
  const auto refused = [&](const fs::path& path, const char* why) {
    EXPECT_THAT([&] { check_output({"-o", path, any}, {}); }, ThrowsMessage<ConfigurationError>(HasSubstr(why)));
  };
  refused(loop, "leads back to itself");
  refused(device, "not a regular file");
}

/// If the folder belongs to somebody else, a new file replaces a link of the same name.
TEST(OwnFiles, TakeThePlaceOfLinks) {
  const TemporaryFolder folder;
  const fs::path theirs = folder.path() / "theirs", own = folder.path() / "own";
  write_file(theirs, "precious");
  for (const fs::path& target : {theirs, fs::path("/dev/full"), own, folder.path() / "nowhere", folder.path()}) {
    fs::remove(own);
    fs::create_symlink(target, own);
    EXPECT_EQ(write_obstacle(own), "");
    replace_file(own, {"ours"});
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(own)));
    EXPECT_EQ(text_of(own), "ours");
  }
  EXPECT_EQ(text_of(theirs), "precious");
  EXPECT_EQ(entries(folder.path()), 2u);
}

TEST(OwnFiles, AreNotAppendedToThroughAnotherName) {
  const TemporaryFolder folder;
  const fs::path theirs = folder.path() / "theirs", own = folder.path() / "own";
  write_file(theirs, "precious");
  fs::create_symlink("theirs", own);
  append_to_file(own, "a");
  append_to_file(own, "b");
  EXPECT_EQ(text_of(own), "ab");
  fs::remove(own);
  fs::create_hard_link(theirs, own);
  append_to_file(own, "c");
  EXPECT_EQ(text_of(own), "preciousc");
  EXPECT_EQ(text_of(theirs), "precious");
}

TEST(OwnFiles, AFolderTakesThePlaceOfALink) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "theirs");
  fs::create_directory_symlink("theirs", folder.path() / "own");
  for (int time = 0; time < 2; ++time) make_own_folder(folder.path() / "own");
  EXPECT_TRUE(fs::is_directory(fs::symlink_status(folder.path() / "own")));
  EXPECT_EQ(entries(folder.path() / "theirs"), 0u);
}

TEST(Outputs, AreNeitherWhatIsReadNorOfAnotherForm) {
  const TemporaryFolder folder;
  const fs::path log = folder.path() / "log.csv", page = folder.path() / "page.html", empty = folder.path() / "empty";
  write_file(log, "time,x\n");
  write_file(page, "<p>old");
  write_file(empty, "");
  const FileForm form = form_by_front("a page", "<p>", 10);
  const auto check = [&](const fs::path& path) { check_output({"-o", path, form}, {log, page}); };
  const auto refused = [&](const fs::path& path, const std::string& why) {
    EXPECT_THAT([&] { check(path); },
                ThrowsMessage<ConfigurationError>("-o: " + path.string() + why + "; name another file"));
  };
  refused(page, " is read by this command");
  const fs::path other = folder.path() / "other.txt";
  write_file(other, "a text of mine");
  refused(other, " exists and is not replaced, because it is not a page");
  fs::create_symlink("page.html", folder.path() / "link");
  refused(folder.path() / "link", " is read by this command");
  fs::create_hard_link(page, folder.path() / "second");
  refused(folder.path() / "second", " is read by this command");
  refused(folder.path() / "." / "page.html", " is read by this command");
  write_file(folder.path() / "old.html", "<p>older");
  for (const char* name : {"old.html", "new.html", "empty"}) EXPECT_NO_THROW(check(folder.path() / name)) << name;
}

}  // namespace
}  // namespace modebank::test
