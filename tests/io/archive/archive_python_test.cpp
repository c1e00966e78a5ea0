#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/io/archive/archive_fixture.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

constexpr const char* python = "/usr/bin/python3";

TEST(ArchivePython, H5pyFindsWhatTheContractPromises) {
  MODEBANK_NEEDS(test::has_python_modules("h5py"), "h5py is absent: apt-get install python3-h5py");
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "full.h5").string();
  write_archive(path, test::full_archive(2, 1));
  const std::string script = (test::golden_dir().parent_path() / "generate/check_archive.py").string();
  EXPECT_EQ(std::system((std::string(python) + " '" + script + "' '" + path + "'").c_str()), 0);
}

}  // namespace
}  // namespace modebank
