// Detects rounded states with data.quantum = auto.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/io/import/import_fixture.hpp"

namespace modebank {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class ImportQuantum : public test::ImportFixture {
 protected:
  ImportQuantum() { options.states.clear(); }

  /// Writes a noisy signal in multiples of `quantum`. Its standard deviation is near one. Its times are those of the
  /// inputs, or lie between them.
  void write_noisy(double quantum) const {
    for (const std::string name : {"a", "b"}) {
      std::string text = "time,x,u\n";
      for (int k = 0; k < 300; ++k) {
        const double x = 1.4 * std::sin(12.9898 * k * k + (name == "a" ? 0.0 : 1.0));
        text += std::to_string(k) + "," + std::to_string(std::round(x / quantum) * quantum) + "," +
                std::to_string(k % 7) + "\n";
      }
      write("pro_" + name + ".csv", text);
    }
  }
};

TEST_F(ImportQuantum, NoneUnlessAskedFor) {
  write_noisy(0.5);
  EXPECT_EQ(import().recording.quantum.size(), 0);
}

TEST_F(ImportQuantum, AutoTakesACoarseOneAndSaysSo) {
  options.quantum_auto = true;
  write_noisy(0.5);
  const ImportedData data = import();
  ASSERT_EQ(data.recording.quantum.size(), 1);
  EXPECT_NEAR(data.recording.quantum(0), 0.5, 1e-9);
  EXPECT_THAT(data.notes, ElementsAre(HasSubstr("x by 0.5")));
}

TEST_F(ImportQuantum, AutoLeavesAFineOneAlone) {
  options.quantum_auto = true;
  write_noisy(0.05);
  const ImportedData data = import();
  EXPECT_EQ(data.recording.quantum.size(), 0);
  EXPECT_THAT(data.notes, IsEmpty());
}

TEST_F(ImportQuantum, GivenOnesAreOnePerStateOrOneForAll) {
  write_noisy(0.5);
  options.quantum = {0.25};
  EXPECT_EQ(import().recording.quantum(0), 0.25);
  options.quantum = {0.25, 0.5};
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("data.quantum has 2 values, but data.state 1"));
}

TEST_F(ImportQuantum, InterpolatedStatesAreExemptAndSaidToBe) {
  options.states = "imu_*.csv";
  options.quantum = {1.0};
  write("pro_a.csv", "time,u\n0,10\n1.2,20\n2,30\n");
  write("imu_a.csv", "time,x\n0,0\n0.5,1\n1,2\n1.5,3\n2,4\n");
  const ImportedData between = import();
  EXPECT_EQ(between.recording.quantum.size(), 0);
  EXPECT_THAT(between.notes, ElementsAre(StartsWith("steps scatter by 24 %"), HasSubstr("interpolated")));
  write("pro_a.csv", "time,u\n0,10\n1,20\n2,30\n");
  const ImportedData at_samples = import();
  EXPECT_EQ(at_samples.recording.quantum(0), 1.0);
  EXPECT_THAT(at_samples.notes, IsEmpty());
}

}  // namespace
}  // namespace modebank
