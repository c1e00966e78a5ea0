#include <cmath>

#include "tests/io/import/import_fixture.hpp"

namespace modebank {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ImportError : public test::ImportFixture {
 protected:
  ImportError() { write_run("1"); }
};

TEST_F(ImportError, MissingColumnIsFoundBeforeAnySampleIsRead) {
  write("pro_1.csv", "time,u\n0,text\n");
  write_run("2");
  write("imu_2.csv", "time,X,y\n0,1,2\n");
  EXPECT_EQ(error<ConfigurationError>(),
            path("imu_2.csv") + " has no column \"x\", did you mean X?; columns: time, X, y");
}

TEST_F(ImportError, MissingColumnOfTwoFiles) {
  options.truth = {"true_x"};
  EXPECT_EQ(error<ConfigurationError>(),
            "no column \"true_x\"; " + path("imu_1.csv") + " has time, x; " + path("pro_1.csv") + " has time, u");
  options.truth.clear();
  options.join = Join::row;
  options.time = {"stamp"};
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("no column \"stamp\""));
}

TEST_F(ImportError, UnreadableFile) {
  std::filesystem::create_directory(folder.path() / "pro_2.csv");
  write("imu_2.csv", "time,x\n0,1\n1,2\n");
  EXPECT_EQ(error<ConfigurationError>(),
            path("pro_2.csv") + ": the folder has neither metadata.yaml nor .bag, .mcap or .db3 files");
}

TEST_F(ImportError, TimeBackwardsOrRepeated) {
  write("imu_1.csv", "time,x\n0,1\n1,2\n0.5,3\n");
  EXPECT_EQ(error<DataError>(), path("imu_1.csv") + ":4: column time: time goes backwards or repeats: 0.5 after 1");
  write_run("1");
  write("pro_1.csv", "time,note,u\n0,\"a\nb\",1\n1,,2\n1,,3\n");
  EXPECT_EQ(error<DataError>(), path("pro_1.csv") + ":5: column time: time goes backwards or repeats: 1 after 1");
}

TEST_F(ImportError, TimeBackwardsInsideOneRunOfAFile) {
  options.inputs = "all.csv";
  options.states.clear();
  options.run = "lap";
  write("all.csv", "lap,time,x,u\na,5,1,1\nb,1,1,1\na,6,1,1\nb,0,1,1\n");
  EXPECT_EQ(error<DataError>(), path("all.csv") + ":5: column time: time goes backwards or repeats: 0 after 1");
}

TEST_F(ImportError, RowCountsMustAgree) {
  options.join = Join::row;
  EXPECT_EQ(error<DataError>(),
            "data.join = row: " + path("pro_1.csv") + " has 3 rows, but " + path("imu_1.csv") + " has 5");
}

TEST_F(ImportError, TooFewSamples) {
  write("pro_1.csv", "time,u\n0,1\n5,2\n");
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("run \"1\" has 1 sample, but needs at least two"),
                                        HasSubstr(path("pro_1.csv")), HasSubstr(path("imu_1.csv"))));
}

TEST_F(ImportError, StreamsThatDoNotOverlap) {
  write("pro_1.csv", "time,u\n1.5e9,1\n1500000001,2\n");
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("do not overlap"), HasSubstr("0 to 2 s")));
  write_run("1");
  options.lag_s = 30;
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("do not overlap"), HasSubstr("lag 30 s")));
}

TEST_F(ImportError, TheFirstRunInOrderIsReported) {
  for (int i = 10; i < 40; ++i) write_run(std::to_string(i));
  for (const char* name : {"12", "17", "33"}) write("imu_" + std::string(name) + ".csv", "time,x\n0,1\n1,bad\n");
  for (int attempt = 0; attempt < 20; ++attempt) ASSERT_THAT(error<DataError>(), HasSubstr("imu_12.csv:3"));
}

TEST_F(ImportError, RunNames) {
  write_run("2");
  options.train = {"1"};
  options.test = {"3"};
  EXPECT_THAT(error<ConfigurationError>(), AllOf(HasSubstr("data.test: unknown run \"3\""), HasSubstr("runs: 1, 2")));
  options.test = {"2", "1"};
  EXPECT_THAT(error<ConfigurationError>(),
              AllOf(HasSubstr("data.test: run \"1\" is already named in data.train"), HasSubstr("runs: 1, 2")));
  options.test.clear();
  options.train = {"1", "1"};
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("already named in data.train"));
}

TEST_F(ImportError, RunColumn) {
  options.inputs = "all.csv";
  options.states.clear();
  options.run = "lap";
  write("all.csv", "lap,time,x,u\na/b,0,1,1\na/b,1,1,1\n");
  EXPECT_THAT(error<DataError>(), HasSubstr("\"a/b\" cannot name a run"));
  write("all.csv", "lap,time,x,u\n*,0,1,1\n*,1,1,1\n");
  EXPECT_THAT(error<DataError>(), HasSubstr("\"*\" cannot name a run")) << "it is all runs in the summary";
  write("all.csv", "lap,time,x,u\na,0,1,1\n,1,1,1\n");
  EXPECT_EQ(error<DataError>(), path("all.csv") + ":3: column lap: missing value");
  write("all.csv", "lap,time,x,u\na,0,1,1\na,1,1,1\nb,1,1,1\n");
  EXPECT_THAT(error<DataError>(), HasSubstr("run \"b\" has 1 sample,"));
  options.train = {"c"};
  write("all.csv", "lap,time,x,u\na,0,1,1\na,1,1,1\n");
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("unknown run \"c\""));
}

TEST_F(ImportError, RunOfOnlyOneFile) {
  options.run = "lap";
  write("pro_1.csv", "lap,time,u\na,0,1\na,1,2\nb,0,1\nb,1,2\n");
  write("imu_1.csv", "lap,time,x\na,0,1\na,1,2\n");
  EXPECT_EQ(error<DataError>(), "run \"b\" is in " + path("pro_1.csv") + ", but not in " + path("imu_1.csv"));
}

TEST_F(ImportError, TwoRunsOfOneName) {
  options.run = "lap";
  options.states.clear();
  write("pro_1.csv", "lap,time,x,u\na,0,1,1\na,1,1,1\n");
  write("pro_1_a.csv", "lap,time,x,u\nb,0,1,1\nb,1,1,1\n");
  write("pro_1.csv", "lap,time,x,u\na_b,0,1,1\na_b,1,1,1\n");
  EXPECT_EQ(error<DataError>(), "two runs are named \"1_a_b\"");
}

TEST_F(ImportError, Options) {
  const DataOptions good = options;
  const auto with = [&](auto change) {
    options = good;
    change(options);
    return error<ConfigurationError>();
  };
  EXPECT_THAT(with([](DataOptions& o) { o.state.clear(); }), HasSubstr("data.state is not set"));
  EXPECT_THAT(with([](DataOptions& o) { o.inputs.clear(); }), HasSubstr("data.inputs is not set"));
  EXPECT_THAT(with([](DataOptions& o) { o.time.clear(); }), HasSubstr("data.time is not set"));
  EXPECT_THAT(with([](DataOptions& o) { o.state = {"x", "x"}; }), HasSubstr("data.state: \"x\" is named twice"));
  EXPECT_THAT(with([](DataOptions& o) { o.input = {"u", ""}; }), HasSubstr("data.input: entry 2 is empty"));
  EXPECT_THAT(with([](DataOptions& o) { o.truth = {"x", "time"}; }), HasSubstr("data.truth names 2 columns"));
  EXPECT_THAT(with([](DataOptions& o) { o.state_unit = {"m", "s"}; }), HasSubstr("data.state_unit has 2 units"));
  EXPECT_THAT(with([](DataOptions& o) { o.input_unit = {"m", "s"}; }), HasSubstr("data.input_unit has 2 units"));
  EXPECT_THAT(with([](DataOptions& o) { o.rate_hz = -1; }), HasSubstr("data.rate_hz = -1"));
  EXPECT_THAT(with([](DataOptions& o) { o.rate_hz = std::nan(""); }), HasSubstr("data.rate_hz = nan"));
  EXPECT_THAT(with([](DataOptions& o) { o.lag_s = INFINITY; }), HasSubstr("data.lag_s = inf"));
  EXPECT_THAT(with([](DataOptions& o) { o.states = "imu.csv"; }), HasSubstr("both or neither"));
}

}  // namespace
}  // namespace modebank
