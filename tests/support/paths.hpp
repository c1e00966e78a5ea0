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

/// CI=true: continuous integration.
bool is_ci();
/// MODEBANK_NIGHTLY=1: every tool that a test can use is installed.
bool is_nightly();

/// Whether the shell finds a program of this name.
bool has_program(const std::string& name);
/// Whether Debian's Python can import the modules ("rosbag, genpy").
bool has_python_modules(const std::string& names);

}  // namespace modebank::test

/// Skips the test, with a reason, if something that is not part of the project is missing. Fails instead if `required`.
#define MODEBANK_NEEDS_UNLESS(present, absence, required)            \
  if (!(present)) {                                                  \
    ASSERT_FALSE(required) << (absence) << " (it is required here)"; \
    GTEST_SKIP() << (absence);                                       \
  }

/// For a test that needs a tool such as Octave. The tool is required in the nightly run (MODEBANK_NIGHTLY=1).
#define MODEBANK_NEEDS(present, absence) MODEBANK_NEEDS_UNLESS(present, absence, ::modebank::test::is_nightly())

/// For a test that needs real data. They are required in continuous integration (CI=true) and in the nightly run.
#define MODEBANK_NEEDS_DATA(present)                                                                            \
  MODEBANK_NEEDS_UNLESS(present, "real data are absent: set MODEBANK_DATA to a folder that holds borealtc/ICE", \
                        ::modebank::test::is_ci() || ::modebank::test::is_nightly())

#define MODEBANK_NEEDS_SHARED_DATA() MODEBANK_NEEDS_DATA(!::modebank::test::shared_data_dir().empty())
