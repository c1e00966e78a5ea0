// Archives whose evaluations are written while they are made, and archives read for an overview alone.
#include <gmock/gmock.h>

#include "io/archive/archive.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/archive/archive_fixture.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using test::full_archive;

class StreamedArchive : public ::testing::Test {
 protected:
  /// Hands all evaluations of `archive` to the sink, and keeps the rest.
  void write_streamed(const Archive& archive) {
    Archive rest = archive;
    stream_archive(path, *archive.recording, [&](const EvaluationSink& sink) -> const Archive& {
      for (FilterEvaluation& filter : rest.evaluations) {
        for (std::size_t i = 0; i < filter.runs.size(); ++i)
          sink(filter.filter, i, filter.runs[i], filter.free_runs.empty() ? nullptr : &filter.free_runs[i]);
        filter.runs.clear();
        filter.streamed = true;
      }
      return rest;
    });
  }

  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "a.h5";
};

TEST_F(StreamedArchive, IsTheWholeArchiveBitByBit) {
  const Archive archive = full_archive(2, 1);
  write_streamed(archive);
  EXPECT_EQ(verify_archive(path).problems, std::vector<std::string>());
  test::expect_same(read_archive(path), archive);
}

TEST_F(StreamedArchive, ThrowsWhatItsMakerThrowsAndLeavesNothing) {
  const Archive archive = full_archive(1, 1);
  const auto failing = [&](const EvaluationSink& sink) -> const Archive& {
    sink("bank", 0, archive.evaluations.front().runs.front(), nullptr);
    throw DataError("the data are odd");
  };
  EXPECT_THAT([&] { stream_archive(path, *archive.recording, failing); },
              ::testing::ThrowsMessage<DataError>("the data are odd"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST_F(StreamedArchive, AnOverviewHoldsAllButTheRunsThatItDoesNotShow) {
  const Archive archive = full_archive(2, 1);
  write_archive(path, archive);
  const Archive overview = read_overview(path, 1);
  ASSERT_EQ(overview.evaluations.size(), archive.evaluations.size());
  std::vector<std::string> read;
  for (const FilterEvaluation& filter : overview.evaluations)
    for (std::size_t i = 0; i < filter.runs.size(); ++i)
      if (filter.runs[i].prediction.size() > 0) {
        read.push_back(filter.filter);
        EXPECT_EQ(archive.recording->runs[i].role, Role::test);
        test::expect_same(filter.runs[i], archive.evaluations.front().runs[i]);
      }
  EXPECT_EQ(read, std::vector<std::string>{"bank"});
  Archive rest = read_archive(path), shown = overview;
  for (Archive* one : {&rest, &shown}) {
    one->evaluations.clear();
    one->residual_tests.clear();
  }
  test::expect_same(shown, rest);
  EXPECT_EQ(overview.residual_tests.size(), archive.residual_tests.size());
}

TEST_F(StreamedArchive, ReadByRunsLeavesThemInTheFile) {
  const Archive archive = full_archive(2, 1);
  write_archive(path, archive);
  const Archive by_runs = read_archive_by_runs(path, 0);
  ASSERT_EQ(by_runs.evaluations.size(), archive.evaluations.size());
  for (std::size_t f = 0; f < archive.evaluations.size(); ++f) {
    const FilterEvaluation &filter = by_runs.evaluations[f], &whole = archive.evaluations[f];
    ASSERT_EQ(filter.runs.size(), whole.runs.size());
    EXPECT_EQ(filter.free_runs.empty(), whole.free_runs.empty());
    for (std::size_t i = 0; i < whole.runs.size(); ++i) {
      EXPECT_EQ(filter.runs[i].pit.size() + filter.runs[i].nis.size(), 0);
      filter.with_run(i, {"pit", "mode_probability"}, [&](const RunEvaluation& said) {
        EXPECT_TRUE(test::same_bits(said.pit, whole.runs[i].pit));
        EXPECT_TRUE(test::same_bits(said.mode_probability, whole.runs[i].mode_probability));
        EXPECT_EQ(said.prediction.size(), 0) << "nobody asked for it";
      });
      if (!whole.free_runs.empty())
        filter.with_free_run(i, [&](const FreeRun& run) {
          EXPECT_TRUE(test::same_bits(run.mean, whole.free_runs[i].mean));
          EXPECT_TRUE(test::same_bits(run.upper, whole.free_runs[i].upper));
        });
    }
  }
  Archive rest = archive, read = by_runs;
  for (Archive* one : {&rest, &read}) {
    one->evaluations.clear();
    WindowFits& windows = *one->windows;
    windows.information = windows.r_squared = windows.weighed_information = Eigen::MatrixXd();
    windows.condition = windows.inlier_fraction = windows.aic = Eigen::VectorXd();
  }
  test::expect_same(read, rest);
  test::expect_same(read_archive_by_runs(path), archive);  // few samples are in memory
}

TEST_F(StreamedArchive, ReadByRunsIsJudgedAsAWhole) {
  Archive archive = full_archive(1, 1);
  archive.evaluations.back().runs.back().pit(0, 1) = 2.0;
  write_archive(path, archive);
  const auto refused = ::testing::ThrowsMessage<DataError>(::testing::HasSubstr("/pit: holds 2 at (1, 0)"));
  EXPECT_THAT([&] { read_archive(path); }, refused);
  EXPECT_THAT([&] { read_archive_by_runs(path, 0); }, refused);
}

}  // namespace
}  // namespace modebank
