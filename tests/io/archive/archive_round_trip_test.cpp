#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/uniform_01.hpp>

#include "filter/judge/evaluate.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"
#include "ident/fit/fit_windows.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/archive/archive_fixture.hpp"
#include "tests/io/archive/archive_patch.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using test::expect_same;
using test::full_archive;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Archive round_trip(const Archive& archive) {
  const test::TemporaryFolder folder;
  write_archive(folder.path() / "a.h5", archive);
  EXPECT_EQ(verify_archive(folder.path() / "a.h5").problems, std::vector<std::string>());
  return read_archive(folder.path() / "a.h5");
}

TEST(ArchiveRoundTrip, EveryFieldBitByBitForTwoStatesAndOneInput) {
  const Archive archive = full_archive(2, 1);
  expect_same(round_trip(archive), archive);
}

TEST(ArchiveRoundTrip, EveryFieldBitByBitForOneStateAndTwoInputs) {
  const Archive archive = full_archive(1, 2);
  expect_same(round_trip(archive), archive);
}

TEST(ArchiveRoundTrip, ThreeStatesWithoutInputs) {
  const Archive archive = full_archive(3, 0);
  expect_same(round_trip(archive), archive);
}

TEST(ArchiveRoundTrip, KeepsANoiseComponent) {
  Archive archive = full_archive(2, 1);
  GaussianMixture& mixture = archive.mixture->mixture;
  mixture.weights *= 0.875;
  mixture.noise.weight = 0.125;
  mixture.noise.lower = -Eigen::VectorXd::LinSpaced(mixture.features(), 1.0, 2.0);
  mixture.noise.upper = Eigen::VectorXd::LinSpaced(mixture.features(), 0.5, 3.0);
  expect_same(round_trip(archive), archive);
}

/// Fills the features of one-lag fits, and the number of windows on which candidates were compared.
TEST(ArchiveRoundTrip, KeepsFeaturesThatAreNotTheWindowsOwn) {
  Archive archive = full_archive(2, 1);
  MixtureResult& mixture = *archive.mixture;
  mixture.features = Eigen::MatrixXd::Random(mixture.mixture.features(), archive.windows->count());
  mixture.compared = 3;
  const Archive read = round_trip(archive);
  expect_same(read, archive);
  EXPECT_EQ(read.mixture->features, mixture.features);
  EXPECT_EQ(read.mixture->compared, 3);
}

TEST(ArchiveRoundTrip, TermsComeBackOrAreRefused) {
  Archive archive = full_archive(2, 1);
  Bank bent = *archive.one_motion;
  const Eigen::Index q = bent.structure.regressors();
  bent.terms.direction = Eigen::MatrixXd::Identity(q, 2);
  bent.terms.low = Eigen::Vector2d(-1.5, -0.25);
  bent.terms.high = Eigen::Vector2d(2.5, 0.75);
  bent.terms.unit = Eigen::Vector2d(0.5, 0.125);
  bent.terms.terms = {{TermKind::product, {0, 1, 1}},
                      {TermKind::magnitude, {1}},
                      {TermKind::hinge, {0}, -0.375},
                      {TermKind::product, {0, 0}}};
  for (Mode& mode : bent.modes) {
    mode.bend = Eigen::MatrixXd::Random(2, 4);
    mode.bend_standard_error = Eigen::MatrixXd::Constant(2, 4, 0.0625);
  }
  archive.nonlinear = bent;
  archive.finding->description = Description::one_nonlinear_motion;
  archive.finding->equations = {"a[k+1] = 0.5 a[k]", "p1 = b[k]"};
  expect_same(round_trip(archive), archive);
  archive.nonlinear->terms.unit(1) = 0.0;
  const test::TemporaryFolder folder;
  write_archive(folder.path() / "a.h5", archive);
  EXPECT_THROW(read_archive(folder.path() / "a.h5"), DataError);
}

TEST(ArchiveRoundTrip, ABankWhoseNoiseFollowsStateAndInputIsRefused) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  write_archive(path, full_archive(2, 1));
  test::craft(path,
              [](hid_t file) { H5Ocopy(file, "/bank/weight", file, "/bank/noise_weights", H5P_DEFAULT, H5P_DEFAULT); });
  EXPECT_FALSE(verify_archive(path).problems.empty());
  EXPECT_THAT([&] { read_archive(path); }, ThrowsMessage<DataError>(HasSubstr("noise follows state and input")));
}

TEST(ArchiveRoundTrip, ABankThatNoFilterCanRunIsRefusedAtLoad) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  for (const double odd : {not_a_number, -1.0, 0.0}) {
    Archive archive = full_archive(2, 1);
    archive.bank->initial_probability.setConstant(odd);
    write_archive(path, archive);
    EXPECT_FALSE(verify_archive(path).problems.empty());
    EXPECT_THROW(read_archive(path), DataError);
    EXPECT_THROW(load_bank(path), DataError);
  }
  for (const std::vector<Eigen::Index>& motion : {std::vector<Eigen::Index>{0, 2, 2}, {0, 1, 3}, {0, -1, 0}}) {
    Archive archive = full_archive(2, 1);
    archive.bank->motion = motion;
    write_archive(path, archive);
    EXPECT_THROW(load_bank(path), DataError) << "numbers of motions with a hole, or out of range";
  }
}

TEST(ArchiveRoundTrip, KeepsQuanta) {
  Archive archive = full_archive(2, 1);
  archive.recording->quantum = archive.bank->quantum = archive.drifting->quantum = Eigen::Vector2d(0.1, 0.0);
  const Archive read = round_trip(archive);
  EXPECT_EQ(read.recording->quantum, archive.recording->quantum);
  EXPECT_EQ(read.bank->quantum, archive.bank->quantum);
  EXPECT_EQ(read.drifting->quantum, archive.drifting->quantum);
  EXPECT_EQ(read.baseline->quantum.size(), 0);
}

TEST(ArchiveRoundTrip, ABankWithQuantaThatAreNoneIsRefusedAtLoad) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.h5";
  Archive archive = full_archive(2, 1);
  archive.bank->quantum = Eigen::Vector2d(0.1, -1.0);
  write_archive(path, archive);
  EXPECT_THROW(load_bank(path), DataError);
}

TEST(ArchiveRoundTrip, LargeArchivesAreMadeInTheFileSystem) {
  const Archive archive = full_archive(2, 1);
  const test::TemporaryFolder folder;
  write_large_archive(folder.path() / "a.h5", archive);
  EXPECT_EQ(verify_archive(folder.path() / "a.h5").problems, std::vector<std::string>());
  expect_same(read_archive(folder.path() / "a.h5"), archive);
}

/// A run of the linear system with 300 samples. Its name contains characters that are not ASCII.
Recording streamed_recording() {
  Recording recording;
  recording.states = {{"wz", "rad/s"}};
  recording.inputs = {{"left", "m/s"}, {"right", "m/s"}};
  Trajectory run;
  run.run = "fünf";
  run.time_s = Eigen::VectorXd::LinSpaced(300, 0.0, 29.9);
  run.state = run.time_s.array().sin().matrix().transpose();
  run.input.resize(2, 300);
  run.input.row(0) = (1.7 * run.time_s.array()).cos().matrix().transpose();
  run.input.row(1) = (0.6 * run.time_s.array()).sin().matrix().transpose();
  recording.runs = {run};
  return recording;
}

TEST(ArchiveRoundTrip, WindowsWrittenPartByPartAreTheWholeArchive) {
  const Recording recording = streamed_recording();
  FitOptions options;
  const WindowFits whole = fit_windows(recording, options);
  Archive archive;
  archive.recording = recording;
  const test::TemporaryFolder folder;
  write_archive(folder.path() / "parts.h5", archive, whole.count(), [&](const WindowSink& sink) {
    WindowFits part = whole;
    constexpr Index part_windows = 100;
    for (Index first = 0; first < whole.count(); first += part_windows) {
      const Index count = std::min(part_windows, whole.count() - first);
      part.resize(count);
      for (Index i = 0; i < count; ++i) {
        part.windows[i] = whole.windows[first + i];
        part.set(i, whole.at(first + i));
      }
      sink(part, first);
    }
    return whole;
  });
  archive.windows = whole;
  write_archive(folder.path() / "whole.h5", archive);
  EXPECT_EQ(verify_archive(folder.path() / "parts.h5").problems, std::vector<std::string>());
  const WindowFits parts = read_archive(folder.path() / "parts.h5").windows.value();
  expect_same(read_archive(folder.path() / "parts.h5"), read_archive(folder.path() / "whole.h5"));
  EXPECT_EQ(parts.parameters, whole.parameters);
  EXPECT_EQ(parts.count(), whole.count());
}

TEST(ArchiveRoundTrip, AnyStageMayBeAbsent) {
  const Archive full = full_archive(2, 1);
  Archive origin;
  origin.provenance = full.provenance;
  expect_same(round_trip(origin), origin);

  Archive identified = origin;
  identified.recording = full.recording;
  identified.windows = full.windows;
  identified.windows->prior_sd.resize(0);
  expect_same(round_trip(identified), identified);

  Archive bank_only = origin;
  bank_only.bank = full.bank;
  expect_same(round_trip(bank_only), bank_only);

  Archive evaluated = bank_only;
  evaluated.recording = full.recording;
  evaluated.evaluations = {full.evaluations.front()};
  evaluated.summary = full.summary;
  expect_same(round_trip(evaluated), evaluated);

  Archive summary_only = origin;
  summary_only.summary = full.summary;
  expect_same(round_trip(summary_only), summary_only);
}

TEST(ArchiveRoundTrip, AStoredBankGivesTheSameScores) {
  Archive archive = full_archive(2, 1);
  const Bank stored = *round_trip(archive).bank;
  for (const Trajectory& run : archive.recording->runs)
    expect_same(evaluate_run(stored, run, {}), evaluate_run(*archive.bank, run, {}));
}

TEST(ArchiveRoundTrip, TransitionRowsKeepTheirBits) {
  Archive archive;
  archive.bank = full_archive(2, 1).bank;
  std::mt19937_64 generator = make_generator(1, "transition rows");
  boost::random::uniform_01<double> uniform;
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::Matrix3d rows = Eigen::Matrix3d::NullaryExpr([&](Index, Index) { return uniform(generator); });
    const Eigen::Vector3d sums = rows.rowwise().sum();
    rows.array().colwise() /= sums.array();
    archive.bank->transition = TransitionMatrix(rows);
    ASSERT_TRUE(test::same_bits(round_trip(archive).bank->transition.matrix(), archive.bank->transition.matrix()));
  }
}

TEST(ArchiveRoundTrip, TextsOfAnyLength) {
  Archive archive;
  archive.provenance.command_line = std::string(200000, 'x') + "ä";
  archive.recording = Recording{{{"x", ""}}, {}, {}};
  for (int i = 0; i < 300; ++i) {
    Trajectory run;
    run.run =
        std::string(250, 'r') + std::to_string(1000 + i);  // 75 kB of names; HDF5's limit for small attributes is 64 kB
    run.time_s.resize(0);
    run.state.resize(1, 0);
    run.input.resize(0, 0);
    archive.recording->runs.push_back(run);
  }
  const Archive back = round_trip(archive);
  EXPECT_EQ(back.provenance.command_line, archive.provenance.command_line);
  ASSERT_EQ(back.recording->runs.size(), archive.recording->runs.size());
  EXPECT_EQ(back.recording->runs.back().run, archive.recording->runs.back().run);
}

TEST(ArchiveRoundTrip, RunNamesThatHdf5CannotHoldAreRefused) {
  const test::TemporaryFolder folder;
  for (const std::string& name : {std::string("a/b"), std::string("."), std::string(), std::string("a\0b", 3)}) {
    Archive archive = full_archive(2, 1);
    archive.recording->runs[1].run = name;
    EXPECT_THROW(write_archive(folder.path() / "a.h5", archive), DataError) << name;
  }
  Archive twice = full_archive(2, 1);
  twice.recording->runs[1].run = twice.recording->runs[0].run;
  EXPECT_THROW(write_archive(folder.path() / "a.h5", twice), DataError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ArchiveRoundTrip, SizesThatDisagreeAreRefusedBeforeAnythingIsWritten) {
  const test::TemporaryFolder folder;
  const auto refuses = [&](const char* what, auto change) {
    Archive archive = full_archive(2, 1);
    change(archive);
    EXPECT_THROW(write_archive(folder.path() / "a.h5", archive), std::invalid_argument) << what;
  };
  refuses("information", [](Archive& a) { a.windows->information.conservativeResize(Eigen::NoChange, 5); });
  refuses("labels", [](Archive& a) { a.mixture->labels.conservativeResize(4); });
  refuses("Q", [](Archive& a) { a.bank->modes[1].Q.resize(1, 2); });
  refuses("run of a window", [](Archive& a) { a.windows->windows[2].run = 3; });
  refuses("windows without runs", [](Archive& a) { a.recording.reset(); });
  refuses("run of an evaluation", [](Archive& a) { a.evaluations[1].runs.pop_back(); });
  refuses("samples", [](Archive& a) { a.evaluations[1].runs[0].nis.conservativeResize(3); });
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace modebank
