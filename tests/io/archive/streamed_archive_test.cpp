// Archives whose evaluations are written as soon as they are made, or stay in the file during reading.
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
  /// Passes all evaluations of `archive` to the sink, training runs first. Returns the other parts of the archive.
  void write_streamed(const Archive& archive) {
    Archive rest = archive;
    write_archive(path, *archive.recording, [&](const EvaluationSink& sink) -> const Archive& {
      for (FilterEvaluation& filter : rest.evaluations) {
        for (const Role role : {Role::train, Role::test})
          for (std::size_t i = 0; i < filter.runs.size(); ++i)
            if (archive.recording->runs[i].role == role)
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
  EXPECT_THAT([&] { write_archive(path, *archive.recording, failing); },
              ::testing::ThrowsMessage<DataError>("the data are odd"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// The numbers of samples of three runs. The middle run is longer than a block of the writer.
Archive long_archive() {
  Archive archive = full_archive(1, 1);
  Recording recording = *archive.recording;
  for (Trajectory& run : recording.runs) run.role = Role::train;
  recording.runs[1].role = Role::test;
  const auto stretch_run = [](Trajectory& run, Index samples) {
    run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples));
    run.state = Eigen::MatrixXd::Random(1, samples);
    run.input = Eigen::MatrixXd::Random(1, samples);
    run.truth.resize(0, 0);
  };
  for (std::size_t i = 0; i < 3; ++i) stretch_run(recording.runs[i], i == 1 ? 70'000 : 40'000);
  archive = Archive();
  archive.recording = recording;
  archive.evaluations = {{"bank", {}}};
  for (const Trajectory& run : recording.runs) {
    RunEvaluation said;
    const Index N = run.samples();
    for (Eigen::MatrixXd* values : {&said.prediction, &said.innovation, &said.state}) *values = run.state;
    for (Eigen::MatrixXd* values : {&said.innovation_covariance, &said.covariance, &said.pit})
      *values = run.state.cwiseAbs();
    said.nis = said.log_density = run.state.row(0).cwiseAbs();
    said.mode_probability_predicted = said.mode_probability = Eigen::MatrixXd::Ones(1, N);
    archive.evaluations.front().runs.push_back(said);
  }
  return archive;
}

TEST_F(StreamedArchive, BlocksOfRowsMeetWhateverTheOrderOfRuns) {
  Archive archive = long_archive();
  RunEvaluation& said = archive.evaluations.front().runs[1];
  said.viterbi_mode = Eigen::VectorXi::Zero(70'000);  // of this run alone
  write_streamed(archive);
  EXPECT_EQ(verify_archive(path).problems, std::vector<std::string>());
  test::expect_same(read_archive(path), archive);
  write_archive(path, archive);
  test::expect_same(read_archive(path), archive);
}

TEST_F(StreamedArchive, ARunThatDoesNotComeIsAnError) {
  const Archive archive = full_archive(1, 1);
  Archive rest = archive;
  rest.evaluations.clear();
  const auto part = [&](const EvaluationSink& sink) -> const Archive& {
    sink("bank", 0, archive.evaluations.front().runs.front(), nullptr);
    return rest;
  };
  EXPECT_THROW(write_archive(path, *archive.recording, part), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST_F(StreamedArchive, EvaluationsStayInTheFile) {
  const Archive archive = full_archive(2, 1);
  write_archive(path, archive);
  const Archive by_runs = read_archive(path, Evaluations::in_file);
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
    windows.information = windows.weighed_information = Eigen::MatrixXd();
    windows.condition = windows.inlier_fraction = Eigen::VectorXd();
  }
  test::expect_same(read, rest);
}

}  // namespace
}  // namespace modebank
