#include "tests/io/import/import_fixture.hpp"

namespace modebank {
namespace {

using test::row;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ImportDerived : public test::ImportFixture {
 protected:
  ImportDerived() {
    write("pro_0.csv", "time,u,steer\n0,1,0.1\n1,2,0.2\n2,3,0.3\n3,4,0.4\n");
    write("imu_0.csv", "time,x,y\n0,0,1\n0.5,1,1\n1,4,1\n1.5,9,2\n2,16,2\n2.5,25,2\n3,36,2\n");
    options.inputs = "pro_0.csv";
    options.states = "imu_0.csv";
  }
  const Trajectory& only_run() {
    data_ = import();
    EXPECT_EQ(data_.recording.runs.size(), 1U);
    return data_.recording.runs.front();
  }

 private:
  ImportedData data_;
};

TEST_F(ImportDerived, ComputesBeforeJoiningWithinOneTable) {
  options.derive = {"s [m/s] = diff(x)", "twice = 2 * u", "more [m] = twice + u"};
  options.state = {"s"};
  options.input = {"more"};
  const Trajectory& run = only_run();
  EXPECT_EQ(run.state, row({2, 6, 14, 22})) << "of the states' own half seconds, (4 - 1) / 0.5 at 1 s";
  EXPECT_EQ(run.input, row({3, 6, 9, 12}));
  const ImportedData data = import();
  EXPECT_EQ(data.recording.states[0].name, "s");
  EXPECT_EQ(data.recording.states[0].unit, "m/s");
  EXPECT_EQ(data.recording.inputs[0].unit, "m");
}

TEST_F(ImportDerived, ComputesAfterJoiningOfSeveralTables) {
  options.derive = {"slip [1] = x - u * y", "turned = slip * steer"};
  options.state = {"slip"};
  options.input = {"u"};
  EXPECT_EQ(only_run().state, row({-1, 2, 10, 28}));
  options.state = {"x", "turned"};
  const Trajectory& run = only_run();
  EXPECT_NEAR(run.state(1, 2), 10 * 0.3, 1e-12);
}

TEST_F(ImportDerived, ComputesRowByRow) {
  write("imu_0.csv", "x,y\n0,1\n4,1\n16,2\n36,2\n");
  options.join = Join::row;
  options.derive = {"slip = x - u * y", "d = diff(x)"};
  options.state = {"slip", "d"};
  const Trajectory& run = only_run();
  EXPECT_EQ(run.state.row(0), row({-1, 2, 10, 28}));
  EXPECT_EQ(run.state.row(1), row({4, 4, 12, 20}));
}

TEST_F(ImportDerived, DifferentiatesRunByRun) {
  write("all.csv", "time,u,x,block\n0,0,0,a\n1,0,1,a\n0,0,7,b\n1,0,9,b\n2,0,9,b\n");
  options.inputs = "all.csv";
  options.states.clear();
  options.run = "block";
  options.derive = {"d = diff(x)"};
  options.state = {"d"};
  const ImportedData data = import();
  ASSERT_THAT(names(data), ElementsAre("a", "b"));
  EXPECT_EQ(data.recording.runs[0].state, row({1, 1}));
  EXPECT_EQ(data.recording.runs[1].state, row({2, 2, 0}));
}

TEST_F(ImportDerived, DifferentiatesStampsOfNanoseconds) {
  write("all.csv", "time,u,x\n1700000000000000000,0,0\n1700000000001000000,0,1\n1700000000002000000,0,3\n");
  options.inputs = "all.csv";
  options.states.clear();
  options.derive = {"d = diff(x)"};
  options.state = {"d"};
  options.time_unit = TimeUnit::ns;
  EXPECT_EQ(only_run().state, row({1000, 1000, 2000}));
}

TEST_F(ImportDerived, OfMissingValuesIsMissing) {
  write("imu_0.csv", "time,x,y\n0,0,1\n0.5,1,1\n1,,1\n1.5,9,2\n2,16,2\n2.5,25,2\n3,36,2\n");
  options.derive = {"z = x + y"};
  options.state = {"z"};
  EXPECT_THAT(error<DataError>(), HasSubstr("imu_0.csv:4: column x: missing value"));
  options.missing = Missing::gap;
  EXPECT_EQ(only_run().state, row({18, 38}));
  options.derive = {"z = 1 / x"};
  options.missing = Missing::error;
  write("imu_0.csv", "time,x,y\n0,1,1\n1,0,1\n2,1,2\n3,1,2\n");
  EXPECT_THAT(error<DataError>(), HasSubstr("imu_0.csv:3: data.derive, z: no finite value"));
}

TEST_F(ImportDerived, IsGapWhereTheConditionIsFalse) {
  write("pro_0.csv", "time,u\n0,1\n1,1\n2,1\n3,0\n4,1\n5,1\n6,1\n");
  write("imu_0.csv", "time,x\n0,0\n1,1\n2,2\n3,3\n4,4\n5,5\n6,6\n");
  for (const Missing how : {Missing::error, Missing::gap, Missing::predict}) {
    options.missing = how;
    options.where = "u > 0";
    ImportedData data = import();
    ASSERT_THAT(names(data), ElementsAre("pro_0.1", "pro_0.2"));
    EXPECT_EQ(data.recording.runs[0].state, row({0, 1, 2}));
    EXPECT_EQ(data.recording.runs[1].state, row({4, 5, 6}));
    options.where = "x < 2.5 || x >= 5";
    data = import();
    EXPECT_EQ(data.recording.runs[1].state, row({5, 6}));
    options.where = "x * u > 3";
    data = import();
    EXPECT_EQ(data.recording.runs[0].state, row({4, 5, 6})) << "of both tables";
  }
  options.where = "x > 100";
  EXPECT_THAT(error<DataError>(), HasSubstr("no two samples in a row"));
}

TEST_F(ImportDerived, NamesWhatIsWrongBeforeAnySampleIsRead) {
  write("imu_0.csv", "time,x,y\nnothing,to,read\n");
  const auto said = [&](std::vector<std::string> derive, const char* where = "") {
    options.derive = std::move(derive);
    options.where = where;
    options.state = {options.derive.empty() ? "x" : options.derive.front().substr(0, 1)};
    return error<ConfigurationError>();
  };
  EXPECT_THAT(said({"a = steeer + 1"}), HasSubstr("data.derive, a: no column \"steeer\", did you mean steer?"));
  EXPECT_THAT(said({"a = a + 1"}), HasSubstr("a uses itself"));
  EXPECT_THAT(said({"a = b", "b = a"}),
              HasSubstr("a uses b, but a derived channel may only use earlier ones; put the line of b before it"));
  EXPECT_THAT(said({"a = x +"}), HasSubstr("data.derive, a: at character 4 (\"end\"): the expression ends too early"));
  EXPECT_THAT(said({"a = x", "a = y"}), HasSubstr("a is defined twice"));
  EXPECT_THAT(said({"x = y"}), HasSubstr("imu_0.csv already has a column of that name"));
  EXPECT_THAT(said({"a"}), HasSubstr("there is no = after the name; expected NAME [unit] = EXPRESSION"));
  EXPECT_THAT(said({"a [m = x"}), HasSubstr("bracket of the unit is not closed"));
  EXPECT_THAT(said({"1a = x"}), HasSubstr("the name is missing"));
  EXPECT_THAT(said({"a = 2"}), HasSubstr("no channel is named"));
  EXPECT_THAT(said({}, "x > xx"), HasSubstr("data.where: no column \"xx\""));
  EXPECT_THAT(said({}, "x = 2"), HasSubstr("data.where: at character 3"));
}

}  // namespace
}  // namespace modebank
