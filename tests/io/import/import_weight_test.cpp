// Reads sample weights from the column data.weight.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/io/import/import_fixture.hpp"

namespace modebank {
namespace {

using test::row;
using ::testing::HasSubstr;

class ImportWeight : public test::ImportFixture {
 protected:
  ImportWeight() { options.weight = "w"; }
};

TEST_F(ImportWeight, IsAColumnOfTheRunsFile) {
  options.states.clear();
  write("pro_a.csv", "time,x,u,w\n0,1,9,1\n1,2,9,0\n2,3,9,2.5\n");
  EXPECT_EQ(import().recording.runs[0].weight.transpose(), row({1, 0, 2.5}));
  options.weight.clear();
  EXPECT_EQ(import().recording.runs[0].weight.size(), 0);
}

TEST_F(ImportWeight, OfTheStatesFileIsInterpolatedAndStaysZeroAroundALeftOutSample) {
  write("pro_a.csv", "time,u\n0,1\n0.25,1\n1,1\n1.75,1\n2.5,1\n3,1\n");
  write("imu_a.csv", "time,x,w\n0,0,1\n1,1,3\n2,2,0\n3,3,1\n");
  EXPECT_EQ(import().recording.runs[0].weight.transpose(), row({1, 1.5, 3, 0, 0, 1}));
}

TEST_F(ImportWeight, OfTheInputsFileIsHeld) {
  write_run("a");
  write("pro_a.csv", "time,u,w\n0,10,1\n1,20,2\n2,30,4\n");
  EXPECT_EQ(import().recording.runs[0].weight.transpose(), row({1, 2, 4}));
  options.rate_hz = 2;
  EXPECT_EQ(import().recording.runs[0].weight.transpose(), row({1, 1, 2, 2, 4}));
}

TEST_F(ImportWeight, StaysWithItsSampleWhenGapsSplitTheRun) {
  options.states.clear();
  options.missing = Missing::gap;
  write("pro_a.csv", "time,x,u,w\n0,1,9,1\n1,2,9,2\n2,,9,3\n3,4,9,4\n4,5,9,5\n");
  EXPECT_EQ(import().recording.runs[1].weight.transpose(), row({4, 5}));
}

TEST_F(ImportWeight, MustBeANumberThatIsNotNegativeAndNotMissing) {
  options.states.clear();
  write("pro_a.csv", "time,x,u,w\n0,1,9,1\n1,2,9,-0.5\n2,3,9,1\n");
  EXPECT_EQ(error<DataError>(),
            path("pro_a.csv") +
                ":3: column w: the weight -0.5 is negative; a weight is at least 0, and 0 leaves the "
                "sample's transition out");
  for (const Missing missing : {Missing::error, Missing::gap, Missing::predict}) {
    options.missing = missing;
    write("pro_a.csv", "time,x,u,w\n0,1,9,1\n1,2,9,NaN\n2,3,9,1\n");
    EXPECT_EQ(error<DataError>(), path("pro_a.csv") + ":3: column w: missing value (\"NaN\")");
  }
  write("pro_a.csv", "time,x,u\n0,1,9\n1,2,9\n");
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("has no column \"w\""));
}

}  // namespace
}  // namespace modebank
