#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::test {

/// A folder with two small runs, each in one file, and their configuration. Each test changes what it needs.
class CliTest : public ::testing::Test {
 protected:
  CliTest();

  ProgramResult modebank(std::vector<std::string> arguments) const;
  /// Runs `modebank run` on the configuration. `options`: more options.
  ProgramResult run(std::vector<std::string> options = {}) const;

  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& content) const { write_file(file(name), content); }
  std::string archive() const { return file("out.h5").string(); }
  std::string config() const { return file("test.ini").string(); }
  /// All files in the folder that the fixture did not make.
  std::vector<std::string> left_behind() const;

  static std::string csv_run(int samples, unsigned seed);
  static const char* config_text();

 private:
  TemporaryFolder folder_;
};

}  // namespace modebank::test
