#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <thread>

#include "io/archive/archive_form.hpp"
#include "io/files/sha256.hpp"
#include "tests/io/archive/archive_file_fixture.hpp"

namespace modebank {
namespace {

namespace fs = std::filesystem;
using test::ArchiveFile;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST_F(ArchiveFile, UserBlockHoldsTheHashOfTheRestAndZeros) {
  const std::string bytes = read_file(path);
  ASSERT_GT(bytes.size(), 512u);
  EXPECT_EQ(bytes.substr(0, 64), sha256_hex(std::string_view(bytes).substr(512)));
  EXPECT_EQ(bytes.substr(64, 448), std::string(448, '\0'));
  EXPECT_EQ(bytes.substr(512, 8), "\x89HDF\r\n\x1a\n");
  EXPECT_THAT(files(), ::testing::ElementsAre("archive.h5"));
}

TEST_F(ArchiveFile, IsWrittenByTwoThreadsAtOnce) {
  const auto write_some = [&](const std::string& name) {
    for (int i = 0; i < 5; ++i) write_archive(folder.path() / name, test::full_archive(2, 1));
  };
  std::thread other([&] { write_some("other.h5"); });
  EXPECT_NO_THROW(write_some("one.h5"));
  other.join();
  EXPECT_EQ(read_file(folder.path() / "one.h5"), read_file(path));
  EXPECT_EQ(read_file(folder.path() / "other.h5"), read_file(path));
}

TEST_F(ArchiveFile, EqualContentsGiveEqualBytes) {
  const fs::path other = folder.path() / "other.h5";
  // HDF5's time stamps are whole seconds.
  for (const std::time_t first = std::time(nullptr); std::time(nullptr) == first;)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  write_archive(other, test::full_archive(2, 1));
  EXPECT_EQ(read_file(path), read_file(other));
  write_archive(other, read_archive(path));
  EXPECT_EQ(read_file(path), read_file(other));
  Archive later = test::full_archive(2, 1);
  later.provenance.created = "2027-01-01T00:00:00Z";
  write_archive(other, later);
  EXPECT_NE(read_file(path), read_file(other));
}

void check(const fs::path& output) { check_output({"archive.output", output, archive_form()}, {}); }

TEST_F(ArchiveFile, NothingIsLeftWhenTheFolderIsMissing) {
  const fs::path missing = folder.path() / "none" / "a.h5";
  EXPECT_THROW(check(missing), ConfigurationError);
  EXPECT_THROW(write_archive(missing, Archive()), DataError);
  EXPECT_FALSE(fs::exists(missing.parent_path()));
  EXPECT_THROW(check(folder.path()), ConfigurationError);
  EXPECT_THROW(write_archive(folder.path(), Archive()), DataError);
  EXPECT_THROW(check("/dev/full"), ConfigurationError);
  EXPECT_THROW(write_archive("/dev/full", Archive()), DataError);
  EXPECT_THROW(check(""), ConfigurationError);
  EXPECT_NO_THROW(check(path));
}

/// Root may write everywhere, so the test temporarily becomes user nobody.
class AsNobody {
 public:
  AsNobody() : was_(geteuid()) {
    constexpr uid_t nobody = 65534;
    if (was_ == 0) changed_ = seteuid(nobody) == 0;
  }
  ~AsNobody() {
    if (changed_ && seteuid(was_) != 0) std::abort();
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  uid_t was_;
  bool changed_ = false;
};

TEST_F(ArchiveFile, NothingIsLeftWhenTheFolderIsNotWritable) {
  const std::string before = read_file(path);
  ASSERT_EQ(chmod(folder.path().c_str(), 0555), 0);
  {
    const AsNobody nobody;
    EXPECT_THAT([&] { check(path); }, ThrowsMessage<ConfigurationError>(HasSubstr("not writable")));
    EXPECT_THAT([&] { write_archive(path, Archive()); }, ThrowsMessage<DataError>(HasSubstr("Permission denied")));
  }
  ASSERT_EQ(chmod(folder.path().c_str(), 0755), 0);
  EXPECT_THAT(files(), ::testing::ElementsAre("archive.h5"));
  EXPECT_EQ(read_file(path), before);
}

}  // namespace
}  // namespace modebank
