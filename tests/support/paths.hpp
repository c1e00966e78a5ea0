#pragma once

#include <filesystem>
#include <string>

namespace modebank::test {

/// The root of the source tree.
std::filesystem::path project_dir();
/// Folder of golden files; its subfolder generate/ has the scripts that made them.
std::filesystem::path golden_dir();

/// Folder of real data: $MODEBANK_DATA, else ../shared/data beside the checkout. Empty if neither exists.
std::filesystem::path shared_data_dir();

/// A temporary folder; the destructor removes it.
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

/// CI=true: continuous integration, where data and every tool that a test can use are present.
bool is_ci();

/// Whether the shell finds a program of this name.
bool has_program(const std::string& name);
/// Whether Debian's Python can import the modules ("rosbag, genpy").
bool has_python_modules(const std::string& names);

}  // namespace modebank::test

/// Skips the test, with a reason, if data or a tool such as Octave is missing. Fails instead in continuous integration.
#define MODEBANK_NEEDS(present, absence)                                                \
  if (!(present)) {                                                                     \
    ASSERT_FALSE(::modebank::test::is_ci()) << (absence) << " (required with CI=true)"; \
    GTEST_SKIP() << (absence);                                                          \
  }

#define MODEBANK_NEEDS_DATA(present) \
  MODEBANK_NEEDS(present, "real data are absent: set MODEBANK_DATA to a folder that holds borealtc/ICE")

#define MODEBANK_NEEDS_SHARED_DATA() MODEBANK_NEEDS_DATA(!::modebank::test::shared_data_dir().empty())
