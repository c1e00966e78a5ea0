// Reads imperfect logs with data.missing and data.disorder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ident/base/not_a_number.hpp"
#include "tests/io/import/import_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;
using test::row;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ImportMissing : public test::ImportFixture {
 protected:
  ImportMissing() { options.states.clear(); }
};

TEST_F(ImportMissing, GapsSplitTheRun) {
  options.missing = Missing::gap;
  options.train = {"a"};
  write("pro_a.csv", "time,x,u\n0,1,9\n1,2,9\n2,NaN,9\n3,4,9\n4,5,\n5,6,9\n6,7,9\n7,8,9\n");
  write("pro_b.csv", "time,x,u\n0,1,9\n1,2,9\n");
  const ImportedData data = import();
  EXPECT_THAT(names(data), ElementsAre("a.1", "a.2", "b")) << "one sample at 3 s is no stretch";
  EXPECT_THAT(names(data, Role::train), ElementsAre("a.1", "a.2")) << "data.train names the whole run";
  EXPECT_EQ(data.recording.runs[0].time_s.transpose(), row({0, 1}));
  EXPECT_EQ(data.recording.runs[1].time_s.transpose(), row({5, 6, 7}));
  EXPECT_EQ(data.recording.runs[1].state, row({6, 7, 8}));
}

TEST_F(ImportMissing, PredictKeepsSamplesAndHoldsInputs) {
  options.missing = Missing::predict;
  write("pro_a.csv", "time,x,u\n0,1,inf\n1,2,10\n2,nan,\n3,,20\n4,5,\n");
  const Trajectory run = import().recording.runs[0];
  EXPECT_EQ(run.time_s.transpose(), row({1, 2, 3, 4})) << "before 1 s no command is known";
  EXPECT_TRUE(near(run.state, row({2, not_a_number, not_a_number, 5}), 0.0));
  EXPECT_EQ(run.input, row({10, 10, 20, 20}));
}

TEST_F(ImportMissing, InterpolationBesideAMissingStateIsMissing) {
  options.states = "imu_*.csv";
  options.missing = Missing::predict;
  write("pro_a.csv", "time,u\n0,1\n0.4,1\n0.5,1\n0.9,1\n1,1\n");
  write("imu_a.csv", "time,x\n0,0\n0.5,\n1,2\n");
  EXPECT_TRUE(near(import().recording.runs[0].state, row({0, not_a_number, not_a_number, not_a_number, 2}), 0.0));
}

TEST_F(ImportMissing, GapsInTimeSplitTheRunInEveryMode) {
  for (const Missing missing : {Missing::error, Missing::gap, Missing::predict}) {
    options.missing = missing;
    write("pro_a.csv", "time,x,u\n0,1,9\n1,2,9\n2,3,9\n3,4,9\n8.5,5,9\n9.5,6,9\n14.5,7,9\n");
    const ImportedData data = import();
    EXPECT_THAT(names(data), ElementsAre("a.1", "a.2"));
    EXPECT_EQ(data.recording.runs[0].time_s.transpose(), row({0, 1, 2, 3}));
    EXPECT_EQ(data.recording.runs[1].time_s.transpose(), row({8.5, 9.5, 14.5})) << "5 periods are no gap";
    EXPECT_THAT(data.notes, ElementsAre(StartsWith("steps scatter by 179 %"),
                                        "run a has gaps, so it is split into 2 runs, a.1 to a.2"));
  }
}

TEST_F(ImportMissing, StatesAreNotInterpolatedAcrossAGap) {
  options.states = "imu_*.csv";
  write("pro_a.csv", "time,u\n0,1\n1,1\n2,1\n3,1\n4,1\n5,1\n");
  write("imu_a.csv", "time,x\n0,0\n0.5,1\n1,2\n1.5,3\n4,8\n4.5,9\n5,10\n");
  EXPECT_THAT(names(import()), ElementsAre("a")) << "5 periods are no gap";
  write("imu_a.csv", "time,x\n0,0\n0.25,0.5\n0.5,1\n0.75,1\n1,2\n1.5,3\n4,8\n4.25,8\n4.5,9\n5,10\n");
  const ImportedData data = import();
  EXPECT_THAT(names(data), ElementsAre("a.1", "a.2"));
  EXPECT_EQ(data.recording.runs[0].time_s.transpose(), row({0, 1}));
  EXPECT_EQ(data.recording.runs[1].state, row({8, 10}));
}

TEST_F(ImportMissing, TimeTextAndRunsWithoutSamplesRemainErrors) {
  for (const Missing missing : {Missing::gap, Missing::predict}) {
    options.missing = missing;
    write("pro_a.csv", "time,x,u\n0,1,9\nnan,2,9\n2,3,9\n");
    EXPECT_EQ(error<DataError>(), path("pro_a.csv") + ":3: column time: missing value (\"nan\")");
    write("pro_a.csv", "time,x,u\n0,1,9\n1,two,9\n2,3,9\n");
    EXPECT_THAT(error<DataError>(), HasSubstr("column x: \"two\" is not a number"));
    write("pro_a.csv", "time,x,u\n0,1,\n1,2,\n2,3,9\n");
    EXPECT_THAT(error<DataError>(), HasSubstr("run \"a\" has no two samples"));
  }
}

TEST_F(ImportMissing, SortOrdersRowsAndKeepsTheFirstOfEachTime) {
  options.disorder = Disorder::sort;
  write("pro_a.csv", "time,x,u\n2,3,30\n0,1,10\n1,2,20\n1,7,70\n");
  const Trajectory run = import().recording.runs[0];
  EXPECT_EQ(run.time_s.transpose(), row({0, 1, 2}));
  EXPECT_EQ(run.state, row({1, 2, 3}));
  EXPECT_EQ(run.input, row({10, 20, 30}));
}

TEST_F(ImportMissing, SortOrdersEachFileOrRowsThatCorrespond) {
  options.disorder = Disorder::sort;
  options.states = "imu_*.csv";
  write("pro_a.csv", "time,u\n1,20\n0,10\n2,30\n");
  write("imu_a.csv", "time,x\n2,3\n1,2\n0,1\n");
  EXPECT_EQ(import().recording.runs[0].state, row({1, 2, 3}));
  options.join = Join::row;
  const Trajectory run = import().recording.runs[0];
  EXPECT_EQ(run.state, row({1, 2, 3})) << "by the states file's time";
  EXPECT_EQ(run.input, row({30, 10, 20}));
}

}  // namespace
}  // namespace modebank
