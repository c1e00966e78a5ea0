#include "app/config/valid_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "modebank/base/error.hpp"
#include "tests/io/import/expect_error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

class ValidConfig : public ::testing::Test {
 protected:
  void load(const std::string& text, const KeyValues& overrides) const {
    const std::filesystem::path file = folder_.path() / "c.ini";
    test::write_file(file, "[data]\ninputs = a.csv\nstate = y\ninput = u\n" + text);
    load_valid_config(file, overrides);
  }
  std::string objection(const std::string& text, const KeyValues& overrides) const {
    return test::message_of<ConfigurationError>([&] { load(text, overrides); });
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(ValidConfig, AnOverrideThatContradictsTheFileSaysWhatToSetToo) {
  const std::string message = objection("[window]\nmodel = varx\nstate_lags = 3\n", {{"window.model", "linear"}});
  EXPECT_THAT(message, HasSubstr("set --window.state_lags 1, too, because "));
  EXPECT_THAT(message, EndsWith("c.ini:7 has 3"));
}

TEST_F(ValidConfig, AllKeysThatStandInTheWayAreNamed) {
  const std::string message =
      objection("[window]\nmodel = varx\nstate_lags = 3\ninput_delay = 2\nlength = 30\n", {{"window.model", "linear"}});
  EXPECT_THAT(message, HasSubstr("set --window.state_lags 1 --window.input_delay 1, too"));
  EXPECT_THAT(message, Not(HasSubstr("window.length")));
}

TEST_F(ValidConfig, DelaysAreOneOrOnePerInput) {
  for (const std::string delays : {"4", "1, 4"})
    EXPECT_NO_THROW(load("[window]\nmodel = varx\ninput_delay = " + delays + "\n", {{"data.input", "a, b"}}));
  EXPECT_THAT(objection("[window]\nmodel = varx\ninput_delay = 1, 4, 2\n", {{"data.input", "a, b"}}),
              HasSubstr("window.input_delay takes one number, or one for each of the 2 inputs"));
  EXPECT_THAT(objection("[window]\nmodel = varx\ninput_delay = 1, -4\n", {}), HasSubstr("out of range"));
}

TEST_F(ValidConfig, TheAdviceHelps) {
  EXPECT_NO_THROW(
      load("[window]\nmodel = varx\nstate_lags = 3\n", {{"window.model", "linear"}, {"window.state_lags", "1"}}));
}

TEST_F(ValidConfig, AFileThatContradictsItselfGetsNoAdvice) {
  EXPECT_THAT(objection("[window]\nmodel = linear\nstate_lags = 3\n", {}), Not(HasSubstr("too, because")));
}

TEST_F(ValidConfig, WhatNoDefaultMendsGetsNoAdvice) {
  EXPECT_THAT(objection("[window]\nlength = 30\n", {{"window.model", "icr"}, {"window.state_lags", "3"}}),
              Not(HasSubstr("too, because")));
}

}  // namespace
}  // namespace modebank::app
