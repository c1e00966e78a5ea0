#include "io/import/import.hpp"

#include "io/files/sha256.hpp"
#include "tests/io/import/import_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;
using test::row;
using ::testing::ElementsAre;

constexpr double tolerance = 1e-12;  // rounding error of interpolation between small numbers

class Import : public test::ImportFixture {};

TEST_F(Import, JoinsOnTime) {
  write("pro_1.csv", "time,other,u\n-1,a,9\n0,b,10\n0.75,c,20\n2,d,30\n2.5,e,40\n");
  write("imu_1.csv", "x,time\n0,0\n1,0.5\n2,1\n3,1.5\n8,2\n");
  const ImportedData data = import();
  ASSERT_EQ(data.recording.runs.size(), 1);
  const Trajectory& run = data.recording.runs[0];
  EXPECT_EQ(run.run, "1");
  EXPECT_EQ(run.role, Role::train);
  EXPECT_EQ(run.time_s.transpose(), row({0, 0.75, 2}));
  EXPECT_EQ(run.state, row({0, 1.5, 8}));
  EXPECT_EQ(run.input, row({10, 20, 30}));
  EXPECT_EQ(run.truth.size(), 0);
  EXPECT_EQ(run.lag_s, 0.0);
}

TEST_F(Import, JoinsRowByRow) {
  options.join = Join::row;
  write("pro_1.csv", "Time,u\n1.5e9,10\n1.4e9,20\n7,30\n");
  write("imu_1.csv", "x,time\n1,0\n2,0.5\n3,0.75\n");
  const Trajectory states_time = import().recording.runs[0];
  EXPECT_EQ(states_time.time_s.transpose(), row({0, 0.5, 0.75}));
  EXPECT_EQ(states_time.state, row({1, 2, 3}));
  EXPECT_EQ(states_time.input, row({10, 20, 30}));

  write("pro_1.csv", "time,u\n1,10\n2,20\n3,30\n");
  write("imu_1.csv", "x,Time\n1,0\n2,0.5\n3,0.75\n");
  EXPECT_EQ(import().recording.runs[0].time_s.transpose(), row({1, 2, 3})) << "then the inputs file";

  write("imu_1.csv", "x,time\n1,0\n2,0.5\n3,0.75\n");
  EXPECT_EQ(import().recording.runs[0].time_s.transpose(), row({0, 0.5, 0.75})) << "the states file comes first";
}

TEST_F(Import, ReadsStatesAndInputsOfOneFile) {
  options.states.clear();
  options.state = {"x2", "x1"};
  options.truth = {"t2", "t1"};
  write("pro_1.csv", "time,x1,x2,u,t1,t2\n0,1,2,3,-1,-2\n1,4,5,6,-4,-5\n");
  const Trajectory run = import().recording.runs[0];
  EXPECT_EQ(run.state, (Eigen::MatrixXd(2, 2) << 2, 5, 1, 4).finished());
  EXPECT_EQ(run.truth, (Eigen::MatrixXd(2, 2) << -2, -5, -1, -4).finished());
  EXPECT_EQ(run.input, row({3, 6}));
}

TEST_F(Import, LooksTruthUpInStatesThenInputs) {
  options.state = {"x", "y"};
  options.truth = {"tx", "ty"};
  write("pro_1.csv", "time,u,tx,ty\n0,1,50,60\n1,2,51,61\n2,3,52,62\n");
  write("imu_1.csv", "time,x,y,tx\n0,0,0,100\n1.6,1,1,116\n2,2,2,120\n");
  const Trajectory run = import().recording.runs[0];
  EXPECT_TRUE(near(run.truth, (Eigen::MatrixXd(2, 3) << 100, 110, 120, 60, 61, 62).finished(), tolerance));
}

TEST_F(Import, ResamplesStatesLinearlyAndHoldsInputs) {
  write_run("1");
  options.rate_hz = 4;
  const Trajectory run = import().recording.runs[0];
  EXPECT_TRUE(near(run.time_s.transpose(), row({0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2}), tolerance));
  EXPECT_TRUE(near(run.state, row({0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4}), tolerance));
  EXPECT_EQ(run.input, row({10, 10, 10, 10, 20, 20, 20, 20, 30}));
}

TEST_F(Import, LagDelaysInputs) {
  write_run("1");
  options.lag_s = 1;
  const Trajectory later = import().recording.runs[0];
  EXPECT_EQ(later.time_s.transpose(), row({1, 2}));
  EXPECT_EQ(later.state, row({2, 4}));
  EXPECT_EQ(later.input, row({10, 20})) << "at t the input u(t - 1) acts";
  EXPECT_EQ(later.lag_s, 1.0);
  options.lag_s = -1;
  const Trajectory earlier = import().recording.runs[0];
  EXPECT_EQ(earlier.time_s.transpose(), row({0, 1}));
  EXPECT_EQ(earlier.input, row({20, 30}));
  options.lag_s = 0.5;
  EXPECT_EQ(import().recording.runs[0].input, row({10, 20})) << "held between samples";
}

TEST_F(Import, RunColumnSeparatesRunsOfOneFile) {
  options.inputs = "all.csv";
  options.states.clear();
  options.run = "block";
  write("all.csv", "block,time,x,u\n10,0,1,2\n2,0,3,4\n10,1,5,6\n2,0.5,7,8\n2,0.6,9,10\n");
  const ImportedData data = import();
  EXPECT_THAT(names(data), ElementsAre("10", "2"));
  EXPECT_EQ(data.recording.runs[0].state, row({1, 5}));
  EXPECT_EQ(data.recording.runs[1].state, row({3, 7, 9}));
  EXPECT_EQ(data.recording.runs[1].time_s.transpose(), row({0, 0.5, 0.6}));
  EXPECT_EQ(data.files.size(), 1);
}

TEST_F(Import, RunColumnOfSeveralFiles) {
  options.run = "lap";
  options.test = {"a_two"};
  write("pro_b.csv", "lap,time,u\none,0,1\none,1,2\n");
  write("imu_b.csv", "lap,time,x\none,0,3\none,1,4\n");
  write("pro_a.csv", "lap,time,u\none,0,5\ntwo,0,6\none,1,7\ntwo,1,8\n");
  write("imu_a.csv", "lap,time,x\ntwo,0,9\ntwo,1,10\none,0,11\none,1,12\n");
  const ImportedData data = import();
  EXPECT_THAT(names(data), ElementsAre("a_one", "a_two", "b_one"));
  EXPECT_THAT(names(data, Role::test), ElementsAre("a_two"));
  EXPECT_EQ(data.recording.runs[0].state, row({11, 12}));
  EXPECT_EQ(data.recording.runs[1].state, row({9, 10}));
  EXPECT_EQ(data.recording.runs[1].input, row({6, 8}));
}

TEST_F(Import, RowJoinWithRunColumnInOneFile) {
  options.join = Join::row;
  options.inputs = "pro.csv";
  options.states = "imu.csv";
  options.run = "lap";
  write("pro.csv", "lap,u\nb,1\na,2\nb,3\na,4\n");
  write("imu.csv", "time,x\n0,5\n0,6\n1,7\n1,8\n");
  const ImportedData data = import();
  EXPECT_THAT(names(data), ElementsAre("a", "b"));
  EXPECT_EQ(data.recording.runs[0].state, row({6, 8}));
  EXPECT_EQ(data.recording.runs[0].input, row({2, 4}));
}

TEST_F(Import, DefaultRolesAlternateInNameOrder) {
  for (const char* name : {"03", "00", "07", "05", "10"}) write_run(name);
  EXPECT_THAT(names(import()), ElementsAre("00", "03", "05", "07", "10"));
  EXPECT_THAT(names(import(), Role::train), ElementsAre("00", "05", "10"));
}

TEST_F(Import, NamedRoles) {
  for (const char* name : {"a", "b", "c", "d"}) write_run(name);
  options.train = {"d", "b"};
  EXPECT_THAT(names(import(), Role::train), ElementsAre("b", "d"));
  EXPECT_THAT(names(import(), Role::test), ElementsAre("a", "c")) << "no test named: all others";
  options.train.clear();
  options.test = {"a"};
  EXPECT_THAT(names(import(), Role::train), ElementsAre("b", "c", "d")) << "no train named: all others";
  options.train = {"c"};
  EXPECT_THAT(names(import()), ElementsAre("a", "c")) << "named in neither: left out";
}

TEST_F(Import, RunsLeftOutAreNotRead) {
  write_run("a");
  write_run("b");
  write("pro_c.csv", "");
  options.train = {"a"};
  options.test = {"b"};
  EXPECT_EQ(import().files.size(), 4);
}

TEST_F(Import, ChannelsAndUnits) {
  options.state = {"x", "y"};
  options.state_unit = {"rad/s", "m"};
  options.input = {"u", "v"};
  options.input_unit = {"m/s"};
  write("pro_1.csv", "time,u,v\n0,1,2\n1,3,4\n");
  write("imu_1.csv", "time,x,y\n0,1,2\n1,3,4\n");
  const Recording recording = import().recording;
  EXPECT_EQ(recording.states[0].name, "x");
  EXPECT_EQ(recording.states[0].unit, "rad/s");
  EXPECT_EQ(recording.states[1].unit, "m");
  EXPECT_EQ(recording.inputs[0].unit, "m/s");
  EXPECT_EQ(recording.inputs[1].name, "v");
  EXPECT_EQ(recording.inputs[1].unit, "m/s");
  options.input_unit.clear();
  EXPECT_EQ(import().recording.inputs[0].unit, "");
}

TEST_F(Import, WorksWithoutInputs) {
  write_run("1");
  options.input.clear();
  EXPECT_EQ(import().recording.runs[0].input.rows(), 0);
  EXPECT_EQ(import().recording.runs[0].samples(), 3);
}

TEST_F(Import, ListsFilesWithTheirHashes) {
  write_run("b");
  write_run("a");
  write("imu_a.csv", "time,x\n0,1\n2,4\n");
  const ImportedData data = import();
  const std::string pro = "time,u\n0,10\n1,20\n2,30\n", imu_a = "time,x\n0,1\n2,4\n",
                    imu_b = "time,x\n0,0\n0.5,1\n1,2\n1.5,3\n2,4\n";
  ASSERT_EQ(data.files.size(), 4);
  EXPECT_EQ(data.files[0].path, path("pro_a.csv"));
  EXPECT_EQ(data.files[1].path, path("imu_a.csv"));
  EXPECT_EQ(data.files[2].path, path("pro_b.csv"));
  EXPECT_EQ(data.files[1].bytes, imu_a.size());
  EXPECT_EQ(data.files[1].sha256, sha256_hex(imu_a));
  EXPECT_EQ(data.data_hash, sha256_hex(sha256_hex(pro) + sha256_hex(imu_a) + sha256_hex(pro) + sha256_hex(imu_b)));
}

// The two-file layout of the recordings of Salvi et al. (2025). The rows of both files correspond. The filtered gyro
// file has a relative `time`. The joint file has an epoch `Time`, and a quoted column that contains commas.
TEST_F(Import, ReadsThePapersLayout) {
  write("TSyn_00.csv",
        ",time,IMU_raw_AngZ,IMU_fil_AngZ\n0,0.0,0.1,0.011\n1,0.0199,0.2,0.012\n2,0.0401,0.3,0.013\n3,0.06,0.4,0.014\n");
  std::string joints = ",Time,header.frame_id,name,velocity_0,velocity_1\r\n";
  for (int i = 0; i < 4; ++i)
    joints += std::to_string(i) + ",1713192601.5" + std::to_string(i) +
              ",,\"['front_left_wheel', 'front_right_wheel']\"," + std::to_string(i) + ".25,-" + std::to_string(i) +
              ".5\r\n";
  write("joint_states_00.csv", joints);
  options.inputs = "joint_states_*.csv";
  options.states = "TSyn_*.csv";
  options.state = {"IMU_fil_AngZ"};
  options.input = {"velocity_0", "velocity_1"};
  options.join = Join::row;
  const ImportedData data = import();
  ASSERT_THAT(names(data), ElementsAre("00"));
  const Trajectory& run = data.recording.runs[0];
  EXPECT_EQ(run.time_s.transpose(), row({0, 0.0199, 0.0401, 0.06}));
  EXPECT_EQ(run.state, row({0.011, 0.012, 0.013, 0.014}));
  EXPECT_EQ(run.input, (Eigen::MatrixXd(2, 4) << 0.25, 1.25, 2.25, 3.25, -0.5, -1.5, -2.5, -3.5).finished());
}

}  // namespace
}  // namespace modebank
