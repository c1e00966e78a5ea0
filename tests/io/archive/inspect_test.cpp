#include "io/archive/inspect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/archive/archive.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/archive/archive_fixture.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class Inspect : public ::testing::Test {
 protected:
  void SetUp() override { write_archive(path, test::full_archive(2, 1)); }
  json at(const std::string& member) const { return inspect(path, member); }

  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "a.h5";
};

TEST_F(Inspect, TheRootListsGroupsAndTheirMembers) {
  const json root = at("/");
  EXPECT_EQ(root["attributes"]["format"], "modebank");
  EXPECT_EQ(root["attributes"]["schema_version"], "4.0");
  EXPECT_EQ(root["members"]["config"], json::parse(R"({"kind": "dataset", "shape": []})"));
  EXPECT_EQ(root["members"]["bank"]["kind"], "group");
  const json& members = root["members"]["bank"]["members"];
  EXPECT_EQ(members["A"]["shape"], json({3, 2, 2}));
  EXPECT_EQ(members["A"]["units"], json::parse(R"json([["1", "(rad/s)/(m/s)"], ["(m/s)/(rad/s)", "1"]])json"));
  EXPECT_EQ(members["screened"], json::parse(R"({"kind": "table", "shape": [1]})"));
  EXPECT_EQ(at(""), root);
}

TEST_F(Inspect, DatasetsOfAnyRankAreNestedAsTheirShape) {
  const Archive archive = test::full_archive(2, 1);
  const json A = at("/bank/A");
  EXPECT_EQ(A["shape"], json({3, 2, 2}));
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_EQ(A["value"][k][i][j].get<double>(),
                  archive.bank->modes[k].model.A(static_cast<Index>(i), static_cast<Index>(j)));
  EXPECT_EQ(at("mixture/labels")["value"], json({0, 2, 1, -1, -1, -1, -1, -1, -1}));
  EXPECT_TRUE(at("mixture/labels")["value"][3].is_number_integer());
  EXPECT_EQ(at("/config")["value"], "[window]\nlength = 5  # fünf\n");
  EXPECT_EQ(at("/windows/run")["value"][2], "10");
  EXPECT_EQ(at("/data/time/")["attributes"]["units"], "s");
}

TEST_F(Inspect, NumbersThatJsonCannotHoldAreNull) {
  EXPECT_TRUE(at("/mixture/responsibilities")["value"][5][0].is_null());
  EXPECT_TRUE(at("/windows/condition")["value"][2].is_null());
}

TEST_F(Inspect, TablesAreRowsWithExactIntegers) {
  const json inputs = at("/provenance/inputs")["value"];
  ASSERT_EQ(inputs.size(), 2u);
  EXPECT_EQ(inputs[0]["bytes"].get<std::uint64_t>(), 9007199254740993u);
  EXPECT_EQ(inputs[1]["path"], "/data/Gelände.csv");
  const json candidate = at("/mixture/candidates")["value"][1];
  EXPECT_EQ(candidate["covariance"], "diagonal");
  EXPECT_EQ(candidate["selected"], 1);
  const json row = at("/evaluation/summary")["value"][1];
  EXPECT_EQ(row["rmse"], json({80.0 + 1.0 / 3.0, 81.0 + 1.0 / 3.0}));
  EXPECT_TRUE(row["whiteness_p"].is_null());
  EXPECT_EQ(at("/baseline/screened")["value"], json::array());
}

TEST_F(Inspect, AttributesKeepTheirKinds) {
  const json windows = at("/windows");
  EXPECT_EQ(windows["attributes"]["length"], 5);
  EXPECT_EQ(windows["attributes"]["parameter_names"][2], "B11");
  EXPECT_EQ(windows["members"]["global"]["members"]["parameters"]["shape"], json({8}));
}

TEST_F(Inspect, OfARunThereAreItsRows) {
  const Archive archive = test::full_archive(2, 1);
  const Trajectory& run = archive.recording->runs[1];
  const json state = inspect(path, "/data/state", run.run);
  EXPECT_EQ(state["shape"], json({run.samples(), 2}));
  for (Index k = 0; k < run.samples(); ++k)
    EXPECT_EQ(state["value"][static_cast<std::size_t>(k)], json({run.state(0, k), run.state(1, k)}));
  EXPECT_EQ(inspect(path, "/evaluation/bank", run.run)["members"]["covariance"]["shape"], json({run.samples(), 2, 2}));
  EXPECT_FALSE(inspect(path, "/data", run.run)["members"].contains("runs"));
  const json whole = inspect(path, "/", run.run);
  EXPECT_EQ(whole["run"]["name"], run.run);
  EXPECT_EQ(whole["run"]["samples"], run.samples());
  EXPECT_EQ(whole["members"]["/evaluation/baseline"]["nis"]["shape"], json({run.samples()}));
  EXPECT_FALSE(whole["members"].contains("/evaluation/evidence"));
  EXPECT_EQ(inspect(path, "/evaluation/summary", "run 2")["value"].size(), 4u);
  EXPECT_EQ(inspect(path, "/residual_tests/lags", run.run)["value"].size(), 8u);  // 4 lags for each of 2 models
  EXPECT_THAT([&] { inspect(path, "/bank/A", run.run); },
              ThrowsMessage<ConfigurationError>(HasSubstr("/bank/A has nothing by run")));
  EXPECT_THAT([&] { inspect(path, "/bank", run.run); },
              ThrowsMessage<ConfigurationError>(HasSubstr("/bank has nothing by run")));
  EXPECT_THAT([&] { inspect(path, "/data/state", "run 3"); },
              ThrowsMessage<ConfigurationError>(AllOf(HasSubstr("no run 'run 3'"), HasSubstr("did you mean run 2"))));
}

TEST_F(Inspect, AWrongPathIsAnsweredWithWhatIsThere) {
  EXPECT_THAT([&] { at("/bank/a"); },
              ThrowsMessage<ConfigurationError>(AllOf(HasSubstr("'a' in /bank"), HasSubstr("transition"))));
  EXPECT_THAT([&] { at("/banks/A/x"); }, ThrowsMessage<ConfigurationError>(HasSubstr("baseline")));
  EXPECT_THAT([&] { at("/bank/A/x"); }, ThrowsMessage<ConfigurationError>(HasSubstr("is a dataset")));
  EXPECT_THROW(inspect(folder.path() / "none.h5", "/"), ConfigurationError);
  EXPECT_THROW(inspect(folder.path(), "/"), DataError);
}

}  // namespace
}  // namespace modebank
