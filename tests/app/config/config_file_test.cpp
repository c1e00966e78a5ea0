#include "app/config/config_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/import/expect_error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app {
namespace {

using test::TemporaryFolder;
using test::write_file;

class ConfigFile : public ::testing::Test {
 protected:
  Config load(const std::string& text, const KeyValues& overrides = {}) const {
    write_file(folder_.path() / "c.ini", text);
    return load_config(folder_.path() / "c.ini", overrides);
  }
  std::filesystem::path folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

TEST_F(ConfigFile, ReadsValuesCommentsAndLists) {
  const Config config = load(
      "\xEF\xBB\xBF# a comment\r\n[data]\r\nstate = wz , vx # trailing\r\n\n[window]\nlength=30\nloss = cauchy\n"
      "[mixture]\ncomponents = 2..4\n[bank]\nmeasurement_variance =\n");
  EXPECT_EQ(config.data.state, (std::vector<std::string>{"wz", "vx"}));
  EXPECT_EQ(config.window.length, 30);
  EXPECT_EQ(config.window.loss, Loss::cauchy);
  EXPECT_EQ(config.mixture.selection.components, (std::vector<Eigen::Index>{2, 3, 4}));
  EXPECT_FALSE(config.bank.measurement_variance.has_value());
}

TEST_F(ConfigFile, NamesStandInQuotesWhereTheyNeedThem) {
  const Config config = load(
      "[data]\nstate = 'Flow, l/h', wz, 'it''s', 'n snow\ntime = \"'Date Time, #1', ns\"  # two\nrun = \"lap#\"\n"
      "derive = \"v = 'wheel#1' / 'a \\\"b\\\"'\"\nderive = w = 2 * wz\nna = -999, bad\nskip_rows = auto\n");
  EXPECT_EQ(config.data.state, (std::vector<std::string>{"Flow, l/h", "wz", "it's", "'n snow"}));
  EXPECT_EQ(config.data.time, (std::vector<std::string>{"Date Time, #1", "ns"}));
  EXPECT_EQ(config.data.run, "lap#");
  EXPECT_EQ(config.data.derive, (std::vector<std::string>{"v = 'wheel#1' / 'a \"b\"'", "w = 2 * wz"}));
  EXPECT_EQ(config.data.format.na, (std::vector<std::string>{"-999", "bad"}));
  EXPECT_TRUE(config.data.format.skip_automatic);
  const Config again = load(resolved_text(config));
  EXPECT_EQ(resolved_text(again), resolved_text(config));
  EXPECT_EQ(again.data.state, config.data.state);
  EXPECT_EQ(again.data.derive, config.data.derive);
  EXPECT_EQ(load("", {{"data.state", "flow#1"}}).data.state, std::vector<std::string>{"flow#1"});
  EXPECT_EQ(load("[data]\nskip_rows = 3\n").data.format.skip_rows, 3U);
  EXPECT_THROW(load("[data]\nskip_rows = -1\n"), ConfigurationError);
  EXPECT_THROW(load("[data]\nrun = \"a\\x1b\"\n"), ConfigurationError) << "control characters";
}

TEST_F(ConfigFile, OtherBytesThanUtf8AreWindows1252) {
  EXPECT_EQ(load("[data]\nstate = gr\xF6\xDF"
                 "e\n")
                .data.state,
            std::vector<std::string>{"größe"});
  EXPECT_EQ(load("[data]\nstate = größe\n").data.state, std::vector<std::string>{"größe"});
}

/// configs/reference.ini, which `make reference-ini` writes, agrees with the program.
TEST_F(ConfigFile, TheReferenceHoldsEveryKeyAtItsDefault) {
  const std::filesystem::path file = test::project_dir() / "configs/reference.ini";
  const Config read = load_config(file, {}), defaults{};
  for (const Option& option : option_table())
    // The defaults of these keys depend on the folder and name of the file.
    if (option.key != "data.root" && option.key != "archive.output" && option.key != "study.output") {
      EXPECT_EQ(option.get(read), option.get(defaults)) << option.key;
    }
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (const Option& option : option_table())
    EXPECT_NE(text.find("\n" + option.name() + " ="), std::string::npos) << option.key;
}

TEST_F(ConfigFile, CommandLineWins) {
  EXPECT_EQ(load("[window]\nlength = 30\n", {{"window.length", "40"}}).window.length, 40);
}

TEST_F(ConfigFile, ResolvedTextIsAConfigurationWithTheSameValues) {
  const Config first = load("[data]\nstate = wz\ninput = a, b\n[window]\nprior = 0.1, 0.2, 0.30000000000000004\n");
  const std::string text = resolved_text(first);
  const Config second = load(text);
  EXPECT_EQ(resolved_text(second), text);
  EXPECT_EQ(second.window.prior_sd, first.window.prior_sd);
  EXPECT_EQ(second.window.prior, Prior::global);
}

TEST_F(ConfigFile, RootIsAbsoluteFromFileThenEnvironmentThenFolder) {
  unsetenv("MODEBANK_DATA");
  EXPECT_EQ(load("").data.root, folder().string());
  EXPECT_EQ(load("[data]\nroot = sub\n").data.root, (folder() / "sub").string());
  setenv("MODEBANK_DATA", "/somewhere", 1);
  EXPECT_EQ(load("").data.root, "/somewhere");
  EXPECT_EQ(load("[data]\nroot = sub\n").data.root, (folder() / "sub").string());
  unsetenv("MODEBANK_DATA");
}

TEST_F(ConfigFile, HashIgnoresWhatDecidesNoNumber) {
  const std::string hash = config_hash(load("[window]\nlength = 30\n"));
  EXPECT_EQ(
      config_hash(load("[job]\nthreads = 2\n[archive]\noutput = x.h5\n[data]\nroot = /x\n[window]\nlength = 30\n")),
      hash);
  EXPECT_NE(config_hash(load("[window]\nlength = 31\n")), hash);
  EXPECT_NE(config_hash(load("[window]\nlength = 30\n[job]\nseed = 2\n")), hash);
}

TEST_F(ConfigFile, EveryOptionReadsItsOwnDefaultBack) {
  const Config defaults{};
  for (const Option& option : option_table()) {
    Config config;
    const std::string text = option.get(defaults);
    // Only texts, lists and optional numbers may be empty.
    EXPECT_NO_THROW(option.set(config, text)) << option.key << " = " << text;
    EXPECT_EQ(option.get(config), text) << option.key;
    EXPECT_FALSE(option.help.empty()) << option.key;
    EXPECT_FALSE(option.range.empty()) << option.key;
  }
}

/// Each fault of the file and of the command line gives one line, with its place and a correct value.
TEST_F(ConfigFile, AllFaultsAreReportedAtOnce) {
  const auto faults = [&](const std::string& text, const KeyValues& overrides) -> std::string {
    try {
      load(text, overrides);
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string place = (folder() / "c.ini").string() + ":";
  const std::string all = faults(
      "[data]\nstte = wz\njust words\n[window]\nlength = long\nloss = huber\nloss = softlone\n", {{"bank.stay", "2"}});
  EXPECT_EQ(all.substr(0, all.find('\n')), "5 settings cannot be used:");
  for (const std::string& part :
       {"\n  " + place + "2: unknown key data.stte, did you mean data.state?",
        "\n  " + place + "3: 'just words' is neither [section] nor key = value",
        "\n  " + place + "5: window.length = 'long' is not a whole number; allowed: ",
        "\n  " + place + "7: window.loss is already set in line 6", std::string("\n  --bank.stay: bank.stay = '2' ")})
    EXPECT_NE(all.find(part), std::string::npos) << part << " not in: " << all;
  EXPECT_EQ(faults("[window]\nlength = long\n", {}).find(place + "2: window.length"), 0u) << "a single one as it is";
}

TEST_F(ConfigFile, DelaysAreOneOrOnePerInput) {
  const auto checked = [&](const std::string& delays) {
    validate(load("[data]\ninputs = a.csv\nstate = y\ninput = a, b\n[window]\nmodel = varx\ninput_delay = " + delays +
                  "\n"));
  };
  for (const std::string delays : {"4", "1, 4"}) EXPECT_NO_THROW(checked(delays));
  EXPECT_THAT(test::message_of<ConfigurationError>([&] { checked("1, 4, 2"); }),
              ::testing::HasSubstr("window.input_delay takes one number, or one for each of the 2 inputs"));
  EXPECT_THAT(test::message_of<ConfigurationError>([&] { checked("1, -4"); }), ::testing::HasSubstr("out of range"));
}

}  // namespace
}  // namespace modebank::app
