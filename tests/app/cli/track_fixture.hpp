#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/cli_fixture.hpp"
#include "tests/support/piped_program.hpp"

namespace modebank::test {

/// An archive of a small run, and lines of the run's files that tests send to `modebank track`.
class Track : public CliTest {
 protected:
  void SetUp() override { ASSERT_EQ(run().status, 0); }

  std::vector<std::string> command(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{MODEBANK_PROGRAM, "track", archive()};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

  /// Lines of a run's file: the header and the samples.
  std::vector<std::string> lines(const std::string& name) const {
    std::ifstream stream(file(name));
    std::vector<std::string> result;
    for (std::string line; std::getline(stream, line);) result.push_back(line);
    return result;
  }

  static std::vector<double> numbers(const std::string& csv) {
    std::vector<double> values;
    std::istringstream stream(csv);
    for (std::string field; std::getline(stream, field, ',');)
      values.push_back(field.empty() ? std::nan("") : std::stod(field));
    return values;
  }
};

}  // namespace modebank::test
