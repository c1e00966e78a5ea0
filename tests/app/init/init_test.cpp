// Results of `modebank init` for logs of all kinds. The program can read the written configurations unchanged.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/config/config.hpp"
#include "app/config/config_file.hpp"
#include "app/init/mounting.hpp"
#include "app/init/proposal.hpp"
#include "app/init/survey_set.hpp"
#include "app/init/survey_text.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app {
namespace {

using test::TemporaryFolder;
using test::write_file;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(NameWords, TellStatesFromInputs) {
  for (const char* name : {"wz", "gyro_z", "yaw_rate", "/imu/data.angular_velocity.z", "level", "y", "output"})
    EXPECT_GT(score_name(name).state, score_name(name).input) << name;
  for (const char* name : {"cmd_velL", "throttle", "steering", "wheel_left", "/cmd_vel.linear.x", "/cmd_vel.angular.z",
                           "pump", "u", "target_speed"})
    EXPECT_GT(score_name(name).input, score_name(name).state) << name;
  for (const char* name : {"header.seq", "orientation_covariance[3]", "time", "/fix.latitude", "run_id", "stamp"})
    EXPECT_TRUE(score_name(name).ignored) << name;
  EXPECT_GT(score_name("/imu/data.angular_velocity.z").state, score_name("/odom.twist.twist.angular.z").state);
}

TEST(CommonPattern, EndsWhereWordsEnd) {
  EXPECT_EQ(common_pattern({"pro_00.csv", "pro_01.csv"}), "pro_*.csv");
  EXPECT_EQ(common_pattern({"ram_01.csv", "rub_03.csv"}), "*.csv");
  EXPECT_EQ(common_pattern({"a1_imu.csv", "b1_imu.csv"}), "*_imu.csv");
  EXPECT_EQ(common_pattern({"log", "data"}), "");
}

/// Writes a configuration as `init` does, and imports its data.
class Init : public ::testing::Test {
 protected:
  std::string write(const std::vector<std::string>& files) {
    const std::vector<FileSet> sets = file_sets(files);
    std::vector<SurveyedFile> surveyed;
    for (const FileSet& set : sets) surveyed.push_back(survey_set(set));
    listing = survey_text(sets, surveyed);
    const Proposal proposal = propose(sets, surveyed, guess_roles(surveyed), folder.path().string());
    const std::string text = configuration_text(proposal, "modebank init");
    write_file(folder.path() / "log.ini", text);
    config = load_config(folder.path() / "log.ini", {});
    validate(config);
    return text;
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  TemporaryFolder folder;
  Config config;
  std::string listing;
};

/// A gyro that lies on its side, for 60 s at 50 Hz. Its y axis points up or down.
std::string sideways(double gravity) {
  std::string text = "time,wx,wy,wz,ax,ay,az,cmd_left,cmd_right\n";
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.02 * k, rate = std::sin(0.7 * t) + 0.3 * std::sin(2.1 * t);
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", t, 0.01 * std::sin(9 * t), gravity > 0 ? rate : -rate,
                        0.02 * std::cos(7 * t), 0.3 * std::sin(5 * t), gravity + 0.2 * std::cos(11 * t),
                        0.1 * std::sin(t), -std::sin(0.7 * t), std::sin(0.7 * t));
  }
  return text;
}

TEST_F(Init, FindsAGyroMountedSideways) {
  write_file(folder.path() / "log.csv", sideways(9.8));
  const std::string text = write({path("log.csv")});
  EXPECT_THAT(text,
              HasSubstr("gravity acts along +y of this instrument (9.80 m/s^2), so it is mounted on its side, and the "
                        "yaw rate is wy, not wz"));
  EXPECT_THAT(config.data.state, ElementsAre("wy"));
  EXPECT_THAT(config.data.input, ElementsAre("cmd_left", "cmd_right"));
  EXPECT_NO_THROW(import_data(config.data));
}

/// Wheels with a largest speed of 4, for commands up to `most`. The yaw rate follows the wheels.
std::string driven(double most) {
  std::string text = "time,wz,cmd_left,cmd_right,wheel_left,wheel_right\n";
  for (int k = 0; k < 1000; ++k) {
    const double left = most * std::sin(0.11 * k), right = most * std::cos(0.07 * k);
    const double l = std::clamp(left, -4.0, 4.0), r = std::clamp(right, -4.0, 4.0);
    text += fmt::format("{},{},{},{},{},{}\n", 0.05 * k, r - l + 0.01 * std::sin(9.0 * k), left, right, l, r);
  }
  return text;
}

TEST_F(Init, CommandsBeyondReachAreNoInputs) {
  write_file(folder.path() / "log.csv", driven(10.0));
  EXPECT_THAT(write({path("log.csv")}), HasSubstr("cmd_left, cmd_right reach 10, but wheel_left, wheel_right never "
                                                  "exceed 4: many commands are not followed"));
  EXPECT_THAT(config.data.input, ElementsAre("wheel_left", "wheel_right"));
  write_file(folder.path() / "log.csv", driven(3.9));
  write({path("log.csv")});
  EXPECT_THAT(config.data.input, ElementsAre("cmd_left", "cmd_right"));
}

TEST_F(Init, TurnsAGyroThatHangsUpsideDown) {
  write_file(folder.path() / "log.csv", sideways(-9.8));
  write({path("log.csv")});
  EXPECT_THAT(config.data.state, ElementsAre("yaw_rate"));
  const ImportedData data = import_data(config.data);
  const Trajectory& run = data.recording.runs.front();
  for (Index k = 0; k < run.samples(); k += 100)
    EXPECT_NEAR(run.state(0, k), std::sin(0.7 * run.time_s(k)) + 0.3 * std::sin(2.1 * run.time_s(k)), 1e-9);
}

TEST_F(Init, PairsFilesAndNamesRuns) {
  for (const char* run : {"00", "01", "02"}) {
    std::string pro = "time,cmd_velL,cmd_velR\n", imu = "time,wz\n";
    for (int k = 0; k < 100; ++k) {
      pro += fmt::format("{},{},{}\n", 0.1 * k, std::sin(k), std::cos(k));
      imu += fmt::format("{},{}\n", 0.1 * k, std::sin(0.3 * k));
    }
    write_file(folder.path() / (std::string("pro_") + run + ".csv"), pro);
    write_file(folder.path() / (std::string("imu_") + run + ".csv"), imu);
  }
  write({path("pro_00.csv"), path("imu_00.csv"), path("pro_01.csv"), path("imu_01.csv"), path("imu_02.csv"),
         path("pro_02.csv")});
  EXPECT_EQ(config.data.inputs, "pro_*.csv");
  EXPECT_EQ(config.data.states, "imu_*.csv");
  EXPECT_THAT(config.data.state, ElementsAre("wz"));
  EXPECT_THAT(config.data.input, ElementsAre("cmd_velL", "cmd_velR"));
  config.data.lag_auto = false;
  EXPECT_EQ(import_data(config.data).recording.runs.size(), 3U);
}

/// A state that follows an input, with 300 rows at 10 Hz. `row` writes one row.
std::string plant(const std::string& head, const std::function<std::string(double, double, double)>& row) {
  std::string text = head;
  double y = 0.0, u = 0.0;
  for (int k = 0; k < 300; ++k) {
    if (k % 9 == 0) u = std::sin(1.7 * k);
    y = 0.8 * y + 0.5 * u + 0.01 * std::sin(37.0 * k);
    text += row(0.1 * k, y, u);
  }
  return text;
}

TEST_F(Init, NamesThatListsCannotHoldGetADeriveLine) {
  const auto row = [](double t, double y, double u) { return fmt::format("{:.1f},{:.6f},{:.6f}\n", t, y, u); };
  write_file(folder.path() / "plain.csv", plant("t,flow,valve\n", row));
  write({path("plain.csv")});
  const Recording expected = import_data(config.data).recording;
  for (const char* time : {"t", "Date Time, GMT+01:00"}) {
    write_file(folder.path() / "comma.csv", plant(fmt::format("\"{}\",\"Flow, l/h\",\"Valve, %\"\n", time), row));
    const std::string text = write({path("comma.csv")});
    EXPECT_THAT(text, HasSubstr("derive = flow = 'Flow, l/h'"));
    EXPECT_THAT(text, HasSubstr("derive = valve = 'Valve, %'"));
    EXPECT_THAT(config.data.state, ElementsAre("flow"));
    EXPECT_THAT(config.data.input, ElementsAre("valve"));
    EXPECT_THAT(config.data.time, ElementsAre(time));
    const Recording recording = import_data(config.data).recording;
    ASSERT_EQ(recording.runs.size(), expected.runs.size());
    EXPECT_EQ(recording.runs[0].state, expected.runs[0].state);
    EXPECT_EQ(recording.runs[0].input, expected.runs[0].input);
    EXPECT_EQ(recording.runs[0].time_s, expected.runs[0].time_s);
  }
  write_file(folder.path() / "quoted.csv", plant("t,flow 'a' x,\"valve \"\"b\"\"\"\n", row));
  EXPECT_THAT(write({path("quoted.csv")}), HasSubstr("derive = flow_a_x = 'flow ''a'' x'"));
  EXPECT_EQ(import_data(config.data).recording.runs[0].state, expected.runs[0].state);
  write_file(folder.path() / "taken.csv", plant("t,\"Flow, l/h\",valve,flow\n", [](double t, double y, double u) {
               return fmt::format("{:.1f},{:.6f},{:.6f},7\n", t, y, u);
             }));
  EXPECT_THAT(write({path("taken.csv")}), HasSubstr("derive = flow_ = 'Flow, l/h'")) << "a column has the other name";
}

TEST_F(Init, NamesWithControlCharactersAreNoSignals) {
  std::string log = "\"cmd\nl\",\"cmd,r\",wz [deg/s],t [ms],throttle\n";
  for (int k = 0; k < 200; ++k) log += fmt::format("{0},{0},{1},{2},{3}\n", k % 7, k % 11, 20 * k, k % 5);
  write_file(folder.path() / "odd.csv", log);
  write({path("odd.csv")});
  EXPECT_THAT(config.data.state, ElementsAre("wz [deg/s]"));
  EXPECT_THAT(config.data.input, ::testing::Contains("cmd"));
  EXPECT_THAT(config.data.time, ElementsAre("t [ms]"));
}

TEST_F(Init, NamesAPlaceWhereNamesSayNothing) {
  std::string text = "c1,c2\n";
  for (int k = 0; k < 50; ++k) text += fmt::format("{},{}\n", std::sin(k), std::cos(2 * k));
  write_file(folder.path() / "log.csv", text);
  EXPECT_THAT(write({path("log.csv")}), HasSubstr("no name indicates the state"));
  EXPECT_THAT(config.data.state, ElementsAre("c2"));
  EXPECT_THAT(config.data.input, ElementsAre("c1"));
  EXPECT_EQ(config.data.rate_hz, 1.0);
  EXPECT_TRUE(config.data.time.empty());
  EXPECT_NO_THROW(import_data(config.data));
}

/// 20 s at 20 Hz with time, wz, cmd and the columns in `more`. The values of these columns increase in steps of 3.
std::string driven(const std::string& more, double input_scale = 1.0) {
  std::string text = "time,wz,cmd" + more + "\n";
  for (int k = 0; k < 400; ++k) {
    text += fmt::format("{},{},{}", 0.05 * k, std::sin(0.3 * k), input_scale * std::cos(0.3 * k));
    for (const char c : more) text += c == ',' ? fmt::format(",{}", 3 * k) : "";
    text += "\n";
  }
  return text;
}

TEST_F(Init, ListsFilesThatNoPatternNamesAlone) {
  for (const char* name : {"run_1.csv", "run_2.csv", "run_3.csv"}) write_file(folder.path() / name, driven(""));
  write({path("run_1.csv"), path("run_3.csv")});
  EXPECT_EQ(config.data.inputs, "run_1.csv, run_3.csv");
  EXPECT_EQ(import_data(config.data).recording.runs.size(), 2U);
  write({path("run_1.csv"), path("run_2.csv"), path("run_3.csv")});
  EXPECT_EQ(config.data.inputs, "run_*.csv");
}

TEST_F(Init, LooksAtAllFilesOfAKind) {
  write_file(folder.path() / "a.csv", driven(",p,only_here", 0.0));
  write_file(folder.path() / "b.csv", driven(",p", 2.0));
  const std::string text = write({path("a.csv"), path("b.csv")});
  EXPECT_THAT(config.data.input, ElementsAre("cmd")) << "it stands still in the first alone";
  EXPECT_THAT(listing, HasSubstr("and 1 more"));
  EXPECT_THAT(listing, HasSubstr("left out, because they are not in all 2 files: only_here"));
  EXPECT_EQ(import_data(config.data).recording.runs.size(), 2U);
}

TEST_F(Init, TakesAColumnThatRisesSteadilyForTheTimes) {
  const std::string text = driven("");
  write_file(folder.path() / "bare.csv", text.substr(text.find('\n') + 1));
  EXPECT_THAT(write({path("bare.csv")}), HasSubstr("rises evenly, 20 times a second, and is taken for the times"));
  EXPECT_EQ(config.data.time.size(), 1U);
  const Trajectory run = import_data(config.data).recording.runs.front();
  EXPECT_NEAR(run.time_s(1) - run.time_s(0), 0.05, 1e-9);
}

}  // namespace
}  // namespace modebank::app
