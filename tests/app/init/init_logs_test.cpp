// Logs with the state and the inputs that a person would choose. The logs come from ../shared/data, from the cases,
// from the documentation and from typical users. If `init` writes a configuration, its data can be imported and cut
// into windows.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "app/cli/init_trial.hpp"
#include "app/config/config_file.hpp"
#include "app/init/proposal.hpp"
#include "app/init/survey_set.hpp"
#include "io/import/derived.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using test::write_file;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Names = std::vector<std::string>;

struct Written {
  Names state, input;
  std::string text;
};

class InitLogs : public ::testing::Test {
 protected:
  TemporaryFolder folder;

  Written init(const Names& files) const {
    const std::vector<FileSet> sets = file_sets(files);
    std::vector<SurveyedFile> surveyed;
    for (const FileSet& set : sets) surveyed.push_back(survey_set(set));
    Proposal proposal = propose(sets, surveyed, guess_roles(surveyed), folder.path().string());
    const fs::path target = folder.path() / "log.ini";
    state_values(proposal);
    make_it_run(proposal, target);
    const std::string text = configuration_text(proposal, "modebank init");
    write_file(target, text);
    const Config config = load_config(target, {});
    return {config.data.state, config.data.input, text};
  }

  /// In the first run, each state must have the values of the column with its name.
  void expect_columns(const Names& header, const std::vector<std::vector<double>>& columns) const {
    Config config = load_config(folder.path() / "log.ini", {});
    validate(config);
    config.data.lag_auto = false;
    const Trajectory run = import_data(config.data).recording.runs.front();
    for (std::size_t i = 0; i < config.data.state.size(); ++i) {
      std::string name = config.data.state[i];
      for (const std::string& line : config.data.derive)
        if (const DerivedChannel derived = parse_derived(line); derived.name == name)
          name = derived.expression.channels().front();
      const auto found = std::find(header.begin(), header.end(), name);
      ASSERT_NE(found, header.end()) << name;
      const std::vector<double>& column = columns[static_cast<std::size_t>(found - header.begin())];
      for (Index k = 0; k < run.samples(); ++k)
        ASSERT_EQ(run.state(static_cast<Index>(i), k), column[static_cast<std::size_t>(k)]) << name << " row " << k;
    }
  }

  std::string write(const std::string& name, const std::string& text) const {
    write_file(folder.path() / name, text);
    return (folder.path() / name).string();
  }
};

/// A robot whose yaw rate follows its wheels, with 20 rows per second. Wheel speeds are held for 40 rows.
struct Drive {
  double t, left, right, rate, noise;
};
std::vector<Drive> drive(int rows) {
  std::vector<Drive> all;
  double rate = 0.0;
  for (int k = 0; k < rows; ++k) {
    const double left = 0.1 * ((k / 40 * 7) % 11 - 5), right = 0.1 * ((k / 40 * 5) % 13 - 6);
    all.push_back({0.05 * k, left, right, rate, 0.01 * std::sin(91.0 * k) * std::cos(37.0 * k)});
    rate += 0.2 * (right - left - rate) + all.back().noise;
  }
  return all;
}

template <class Line>
std::string log_of(const std::string& header, int rows, Line line) {
  std::string text = header;
  for (const Drive& d : drive(rows)) text += line(d) + "\n";
  return text;
}

/// Texts that name runs. Each run lasts from one gap to the next.
TEST_F(InitLogs, ATextThatChangesAtGapsNamesRuns) {
  std::string text = ",time,gyro_z,cmd_left,cmd_right,run,surface\n";
  int k = 0;
  for (const Drive& d : drive(1500)) {
    const int run = k / 300;
    text += fmt::format("{},2024-05-01T{:02}:{:02}:{:06.3f}+02:00,{:.5f},{},{},exp_{},{}\n", k, 10 + run,
                        static_cast<int>(d.t) % 300 / 60, std::fmod(d.t, 60.0), d.rate, d.left, d.right, run,
                        k / 60 % 2 == 0 ? "ice" : "grip");
    ++k;
  }
  const Written written = init({write("pandas.csv", text)});
  EXPECT_THAT(written.text, HasSubstr("run = run"));
  EXPECT_EQ(written.text.find("split ="), std::string::npos);
  EXPECT_EQ(written.state, Names{"gyro_z"});
}

/// Random names of all kinds. Either the configuration has these names and its data can be imported, or the message
/// names the column to rename.
TEST_F(InitLogs, NamesOfAnyLetters) {
  const Names pieces{"v",  "w z", " ", ",", "=", "#", ";",  "\"",   "'",          "[",      "]",     "(",   ")",
                     "\\", "ä",   "µ", "*", "+", "/", "\t", "\x01", "\u0085",     "\u202e", "speed", "cmd", "1",
                     ".",  "-",   "$", "%", "|", ":", "&",  "速",   "\U0001F600", "time",   "pi",    "in",  "x"};
  std::mt19937_64 draw(40);
  const auto name = [&] {
    std::string text;
    for (std::size_t i = 0, length = 1 + draw() % 5; i < length; ++i) text += pieces[draw() % pieces.size()];
    return text;
  };
  const auto field = [](const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
  };
  std::vector<std::vector<double>> columns(3);
  for (const Drive& d : drive(300)) {
    const double values[] = {d.t, d.rate, d.left + d.noise};
    for (std::size_t c = 0; c < 3; ++c) columns[c].push_back(std::round(1e5 * values[c]) / 1e5);
  }
  int written = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Names header{name(), name(), name()};
    std::string text = fmt::format("{},{},{}\n", field(header[0]), field(header[1]), field(header[2]));
    SCOPED_TRACE(text);
    for (std::size_t k = 0; k < 300; ++k)
      text += fmt::format("{:.5f},{:.5f},{:.5f}\n", columns[0][k], columns[1][k], columns[2][k]);
    try {
      init({write("any.csv", text)});
    } catch (const std::exception& error) {
      EXPECT_THAT(error.what(), HasSubstr("rename"));
      continue;
    }
    ++written;
    expect_columns(header, columns);
  }
  EXPECT_GT(written, 100);
}

/// Dates of two files can be read in two ways. The format is proposed with a doubt.
TEST_F(InitLogs, DatesOfSeveralFiles) {
  const auto dated = [&](const std::string& name, const std::string& date) {
    return write(name, log_of("time,wz,cmd\n", 400, [&](const Drive& d) {
                   const auto k = static_cast<int>(std::lround(20 * d.t));
                   return fmt::format("{}/2009 10:{:02}:{:02},{:.5f},{}", date, k / 60, k % 60, d.rate, d.left);
                 }));
  };
  for (const auto& [first, second] : {std::pair{"02/02", "01/02"}, {"01/02", "02/02"}})
    EXPECT_THAT(init({dated("run_1.csv", first), dated("run_2.csv", second)}).text,
                AllOf(HasSubstr("can be read in two ways: %d/%m/%Y"), HasSubstr("time_format = %d/%m/%Y")))
        << first;
}

TEST_F(InitLogs, WritesNothingThatRunRefuses) {
  const std::string few = write("few.csv", log_of("time,y,u\n", 5, [](const Drive& d) {
                                  return fmt::format("{},{},{}", d.t, d.rate + d.t, d.left + d.t);
                                }));
  try {
    init({few});
    FAIL() << "five rows make no window";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no configuration is written, because run would end in: "));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()) || !fs::exists(folder.path() / "log.ini"));
  const std::string still = write("still.csv", "time,y\n0,1\n1,1\n2,1\n");
  EXPECT_THROW(init({still}), DataError);
  // Every run is shorter than a window, but the log as a whole is long enough.
  std::string text = "time,y,u,run\n";
  int k = 0;
  for (const Drive& d : drive(600))
    text += fmt::format("{},{},{},{}\n", d.t - 0.5 * (k / 10), d.rate, d.left, k / 10), ++k;
  const std::string pieces = write("pieces.csv", text);
  try {
    EXPECT_THAT(init({pieces}).text, HasSubstr("# ! "));
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no configuration is written"));
  }
}

/// The data of these configurations need no script before they can be read.
TEST(ShippedConfigurations, FindTheirData) {
  MODEBANK_NEEDS_SHARED_DATA();
  int imported = 0;
  for (const auto& entry : fs::directory_iterator(test::project_dir() / "configs")) {
    if (!entry.is_regular_file()) continue;  // skips the folder of systems
    const std::string name = entry.path().stem().string();
    if (name == "minimal" || name == "reference" || name == "demo" || name.starts_with("simulate")) continue;
    Config config = load_config(entry.path(), {{"data.root", test::shared_data_dir().string()}});
    config.data.lag_auto = false;
    EXPECT_NO_THROW(imported += import_data(data_options_of(config)).recording.runs.empty() ? 0 : 1) << name;
  }
  EXPECT_GE(imported, 10);
}

}  // namespace
}  // namespace modebank::app
