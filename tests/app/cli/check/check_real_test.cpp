// `modebank check` must find the facts that the READMEs of the real data state.
#include "tests/app/cli/check/check_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;

/// This is read before the fixture hides the user's data folder from the program.
const std::filesystem::path shared_data = shared_data_dir();

#define NEEDS_SHARED_DATA() MODEBANK_NEEDS_DATA(!shared_data.empty())

class CheckOfRealData : public Check {
 protected:
  json real(const std::string& data_section) const {
    write("real.ini", "[data]\nroot = " + shared_data.string() + "\n" + data_section);
    return check_json(file("real.ini").string());
  }
};

TEST_F(CheckOfRealData, FindsTheFactsOfBorealTc) {
  NEEDS_SHARED_DATA();
  const json check =
      real("inputs = borealtc/ICE/pro_*.csv\nstates = borealtc/ICE/imu_*.csv\nstate = wz\ninput = velL, velR\n");
  for (const json& channel : check.at("channels")) {  // oddities 2, 4, 7 and 8 in the README
    const bool command = channel.at("kind") == "input";
    EXPECT_NEAR(channel.at("quantum").get<double>(), command ? 1.0 / 127.0 : 0.0, 1e-6);
    EXPECT_EQ(channel.at("saturated").get<double>() > 0.0, command);
    EXPECT_TRUE(command || channel.at("outliers") == 0);
  }
  struct Fact {
    const char* run;
    double still, constant_s, changes;
    int levels_left, levels_right;
  };
  for (const Fact& fact : {Fact{"00", 0, 41, 180, 48, 37}, Fact{"02", 0, 5, 85, 30, 30}, Fact{"04", 5, 15, 12, 10, 9},
                           Fact{"05", 0, 61, 0, 1, 1}, Fact{"10", 0, 134, 6, 7, 7}, Fact{"11", 19, 3, 49, 26, 29}}) {
    const json& run = run_of(check, fact.run);
    EXPECT_NEAR(100 * run.at("still").get<double>(), fact.still, 0.6) << fact.run;
    EXPECT_NEAR(run.at("longest_constant_s").get<double>(), fact.constant_s, 0.6) << fact.run;
    EXPECT_NEAR(run.at("changes").get<double>() * (run.at("inputs_sampling").at("samples").get<double>() - 1.0),
                fact.changes, 1.0)
        << fact.run;
    EXPECT_EQ(run.at("inputs")[0].at("levels"), fact.levels_left) << fact.run;
    EXPECT_EQ(run.at("inputs")[1].at("levels"), fact.levels_right) << fact.run;
  }
  double deficient = 0.0, windows = 0.0;
  for (const json& run : check.at("runs")) {
    EXPECT_EQ(run.at("inputs")[0].at("saturated").get<double>() > 0.0, run.at("run") == "12");
    windows += run.at("windows").get<double>();
    deficient += run.at("windows").get<double>() * run.at("deficient_windows").get<double>();
  }
  EXPECT_GT(deficient, 0.5 * windows) << "method.md, section 2";
}

TEST_F(CheckOfRealData, MarksTheRunsOfIceWithoutExcitation) {
  NEEDS_SHARED_DATA();
  const json ice =
      real("inputs = borealtc/ICE/pro_*.csv\nstates = borealtc/ICE/imu_*.csv\nstate = wz\ninput = velL, velR\n");
  for (const char* name : {"03", "05", "12"})
    EXPECT_EQ(run_of(ice, name).at("lag").at("status"), "not_excited") << name;
}

TEST_F(CheckOfRealData, FindsTheFactsOfDriveBuckAndBag) {
  NEEDS_SHARED_DATA();
  const json drive = real(
      "inputs = drive_husky/husky_samples.csv\nstate = gyro_z\ninput = wheel_left, wheel_right\ntime = t_block\nrun = "
      "block\n");
  for (const json& channel : drive.at("channels")) {
    const bool wheel = channel.at("kind") == "input";
    EXPECT_NEAR(channel.at("repeated").get<double>(), wheel ? 0.50 : 0.004, 0.01);
    if (!wheel) continue;
    EXPECT_GT(channel.at("saturated").get<double>(), 0.02);
    EXPECT_NEAR(channel.at("largest").get<double>(), 6.85, 0.05);
  }
  EXPECT_NEAR(drive.at("lag").at("lag_s").at("mean").get<double>(), -0.3, 0.1) << "the wheels' columns are late";
  EXPECT_NE(drive.at("lag").at("correction"), "none");
  const json buck = real("inputs = sysid_classic/buck_id.csv\nstate = y\ninput = input\ntime = sampling_time\n");
  EXPECT_NEAR(buck.at("channels")[0].at("quantum").get<double>(), 0.2, 1e-9);
  EXPECT_NEAR(buck.at("channels")[1].at("quantum").get<double>(), 0.01, 1e-9);
  const json bag = real(
      "inputs = bags/husky_outdoor_test*_odom.csv\nstates = bags/husky_outdoor_test*_imu.csv\nstate = wy\ninput = vx, "
      "wz\ntime = t\n");
  EXPECT_NEAR(bag.at("runs")[0].at("rest_sd")[0].get<double>(), 2.4e-3, 6e-4);
  EXPECT_NEAR(bag.at("runs")[0].at("rest_mean")[0].get<double>(), -0.4e-3, 3e-4);
}

}  // namespace
}  // namespace modebank::test
