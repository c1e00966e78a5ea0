#pragma once

#include <filesystem>
#include <string>

namespace modebank::test {

/// The checkout.
std::filesystem::path project_dir();
/// Golden files; the scripts that made them are in generate/ beside it.
std::filesystem::path golden_dir();

/// Real data: $MODEBANK_DATA, else ../shared/data beside the checkout; empty when there is none.
std::filesystem::path shared_data_dir();

/// A folder of its own that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void write_file(const std::filesystem::path& path, const std::string& content);

}  // namespace modebank::test

/// What a test needs from outside the project: its absence skips the test with a message, and fails it under CI=true.
#define MODEBANK_NEEDS(present, absence)                                              \
  if (!(present)) {                                                                   \
    const char* ci = std::getenv("CI");                                               \
    ASSERT_FALSE(ci&& std::string(ci) == "true") << (absence) << " (CI requires it)"; \
    GTEST_SKIP() << (absence);                                                        \
  }

#define MODEBANK_NEEDS_SHARED_DATA()                           \
  MODEBANK_NEEDS(!::modebank::test::shared_data_dir().empty(), \
                 "real data is absent: set MODEBANK_DATA to a folder that holds borealtc/ICE")
