#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/archive/archive_fixture.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {

/// The path of an archive in an empty folder.
class ArchiveFile : public ::testing::Test {
 protected:
  void SetUp() override { write_archive(path, full_archive(2, 1)); }
  void expect_unreadable(const std::string& reason) const {
    const auto says = ::testing::AllOf(::testing::HasSubstr(path.string()), ::testing::HasSubstr(reason));
    EXPECT_THAT([&] { read_archive(path); }, ::testing::ThrowsMessage<DataError>(says));
    EXPECT_THAT(verify_archive(path).problems, ::testing::Contains(::testing::HasSubstr(reason)));
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      names.push_back(entry.path().filename().string());
    return names;
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "archive.h5";
};

}  // namespace modebank::test
