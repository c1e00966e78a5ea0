#pragma once

#include <nlohmann/json.hpp>

#include "tests/app/cli_fixture.hpp"

namespace modebank::test {

/// Tests that run `modebank check`.
class Check : public CliTest {
 protected:
  nlohmann::json check_json(const std::string& config, std::vector<std::string> options = {}) const {
    std::vector<std::string> arguments{"check", config, "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = modebank(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }
  static const nlohmann::json& run_of(const nlohmann::json& check, const std::string& name) {
    for (const nlohmann::json& run : check.at("runs"))
      if (run.at("run") == name) return run;
    throw std::runtime_error("no run " + name);
  }
};

}  // namespace modebank::test
