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

}  // namespace
}  // namespace modebank
