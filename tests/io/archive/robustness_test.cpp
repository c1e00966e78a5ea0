// Archives that another program changed and gave a valid hash. Every reader refuses wrong shapes and positions.
// Verification finds wrong values.
#include <limits>

#include "io/archive/bank/load_bank.hpp"
#include "io/archive/inspect.hpp"
#include "io/archive/study_file.hpp"
#include "tests/io/archive/archive_file_fixture.hpp"
#include "tests/io/archive/archive_patch.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

class Robustness : public ArchiveFile {
 protected:
  /// Expects that verification finds the change, then restores the archive.
  void finds(const std::function<void()>& change, const std::string& reason) {
    change();
    EXPECT_THAT(verify_archive(path).problems, Contains(HasSubstr(reason)));
    write_archive(path, full_archive(2, 1));
  }
  void finds_number(const std::string& dataset, std::size_t index, double value, const std::string& reason) {
    finds([&] { patch_number(path, dataset, index, value); }, reason);
  }
  void finds_attribute(const std::string& object, const std::string& name, double value) {
    finds([&] { patch_number_attribute(path, object, name, value); }, object + "/" + name + ": holds");
  }
  /// Expects that readers refuse the changed archive, too.
  void refuses(const std::function<void()>& change, const std::string& reason) {
    change();
    expect_unreadable(reason);
    write_archive(path, full_archive(2, 1));
  }
  void refuses_number(const std::string& dataset, std::size_t index, double value, const std::string& reason) {
    refuses([&] { patch_number(path, dataset, index, value); }, reason);
  }
  void refuses_attribute(const std::string& object, const std::string& name, double value) {
    refuses([&] { patch_number_attribute(path, object, name, value); }, object + "/" + name + ": holds");
  }
};

TEST_F(Robustness, TheArchiveThatIsChangedHereIsWhole) {
  EXPECT_THAT(verify_archive(path).problems, ::testing::IsEmpty());
  EXPECT_NO_THROW(read_archive(path));
}

TEST_F(Robustness, D2StatusOfAWindowOutOfRange) {
  for (const double status : {4.0, 255.0, 100000.0, 2147483647.0, -1.0, -2147483648.0})
    refuses_number("/windows/status", 3, status, "/windows/status: holds");
  refuses_number("/windows/status", 3, 255, "holds 255 at (3), must lie in 0 .. 3");
}

TEST_F(Robustness, D2EveryIndexIsOfSomethingThatIsThere) {
  refuses_number("/mixture/labels", 1, 1e6, "/mixture/labels: holds 1000000 at (1), must lie in -1 .. 2");
  refuses_number("/mixture/labels", 1, -2, "/mixture/labels: holds -2");
  refuses_number("/evaluation/bank/viterbi_mode", 2, 3, "viterbi_mode: holds 3 at (2), must lie in -1 .. 2");
  refuses_number("/evaluation/baseline/free_run_mode", 0, 1, "free_run_mode: holds 1 at (0), must lie in -1 .. 0");
  finds_number("/windows/start", 0, -1e6, "/windows/start: holds");
  refuses_number("/windows/start", 0, 1e6, "reaches beyond run");
  refuses_number("/data/label", 0, 2, "beyond the 2 label_names");
  refuses([&] { patch_cell(path, "/evaluation/diagnostics", "mode", 1, 3); }, "column 'mode' holds 3 at (1)");
  refuses([&] { patch_cell(path, "/evaluation/confusion", "mode", 0, -1); }, "column 'mode' holds -1");
}

TEST_F(Robustness, D2NumbersOfAModelThatCannotBe) {
  for (const double dt_s : {-0.1, 0.0, nan, infinity}) finds_attribute("/bank", "dt_s", dt_s);
  refuses_attribute("/bank", "inputs", std::ldexp(1.0, 62));
  refuses_attribute("/bank", "input_lags", 1e9);
  finds_attribute("/drifting", "dt_s", 0.0);
  for (const double value : {nan, infinity}) {
    finds_number("/bank/A", 0, value, "/bank/A: holds");
    finds_number("/bank/B", 1, value, "/bank/B: holds");
    finds_number("/bank/c", 1, value, "/bank/c: holds");
  }
  finds_number("/drifting/parameters", 0, nan, "drifting");
}

TEST_F(Robustness, D2MatricesThatAreNoCovariances) {
  for (const double variance : {-1.0, nan, infinity}) {
    finds_number("/bank/Q", 0, variance, "/bank/Q: holds");
    finds_number("/baseline/R", 3, variance, "/baseline/R: holds");
  }
  finds_number("/bank/Q", 1, 0.5, "/bank/Q: holds a matrix at (0, 0, 0) that is not a covariance");  // not symmetric
  finds(
      [&] {
        patch_number(path, "/bank/Q", 5, 50.0);
        patch_number(path, "/bank/Q", 6, 50.0);
      },
      "/bank/Q: holds a matrix at (1, 0, 0) that is not a covariance");  // this matrix is not positive semidefinite
  finds_number("/mixture/covariances", 1, 1e3, "/mixture/covariances: holds a matrix");
}

TEST_F(Robustness, D2ProbabilitiesThatDoNotSumToOne) {
  finds_number("/bank/transition", 0, 2.0, "/bank/transition: holds 2");
  finds_number("/bank/transition", 0, 0.5, "/bank/transition: holds probabilities that sum to 0.8");
  finds_number("/bank/initial_probability", 0, 0.0, "/bank/initial_probability: holds probabilities");
  finds_number("/mixture/weights", 0, 0.1, "the weights sum to");
}

TEST_F(Robustness, D2TimesAndNamesThatCannotBe) {
  finds_number("/data/time", 3, -1.0, "/data/time: does not increase at (3)");
  finds_number("/data/time", 3, nan, "/data/time: holds nan");
  finds_number("/data/state", 3, infinity, "/data/state: holds inf");
  finds([&] { patch_text_attribute(path, "/bank", "model", "lin\x1b[2Jear"); }, "control characters");
  refuses(
      [&] {
        replace_by_zeros(path, "/evaluation/bank/mode_probability", {39, 2}, Kind::real);
      },
      "mode_probability: has shape (39, 2), but K is 3");
  refuses(
      [&] {
        replace_by_zeros(path, "/evaluation/bank/pit", {38, 2}, Kind::real);
      },
      "pit: has shape (38, 2), but S is 39");
}

TEST_F(Robustness, AFindingIsAboutRunsAndModesThatAreThere) {
  finds_attribute("/bank", "learned_transitions", -1);
  finds_number("/windows/transitions", 0, 6, "/windows/transitions: holds 6 at (0), must lie in 0 .. 5");
  finds([&] { patch_number_attribute(path, "/evaluation/evidence", "runs", 4); }, "is about 4 runs, there are 3");
  finds([&] { patch_number_attribute(path, "/evaluation/evidence", "modes", 4); }, "is about 4 modes, there are 3");
}

TEST_F(Robustness, AModeIsOneOfItsOwnFilter) {
  refuses([&] { patch_cell(path, "/evaluation/diagnostics", "mode", 1, 2); },
          "diagnostics names mode 2 of the 1 of baseline");
}

TEST_F(Robustness, GroupsAreNamedOnce) {
  const auto names = [&](const std::string& object, const std::string& attribute, std::size_t index,
                         const std::string& text, const std::string& reason) {
    refuses([&] { patch_text_in_list(path, object, attribute, index, text); }, reason);
  };
  names("/evaluation", "filters", 1, "bank", "filters names 'bank' twice");
  finds([&] { patch_text_in_list(path, "/data", "label_names", 0, "snow"); },
        "confusion names the unknown label 'ice'");
  finds([&] { patch_text_attribute(path, "/evaluation/evidence", "best_competitor", "../x"); },
        "evidence names the unknown filter '../x'");
}

TEST_F(Robustness, RowsOfRunsFollowEachOther) {
  refuses([&] { patch_cell(path, "/data/runs", "first", 1, 11); }, "has rows 11 and");
  refuses([&] { patch_cell(path, "/data/runs", "samples", 2, 15); }, "but S is 40");
  refuses([&] { patch_cell(path, "/data/runs", "samples", 2, -1); }, "-1");
  refuses([&] { patch_cell(path, "/data/runs", "samples", 2, 9e18); }, "S is");
}

TEST_F(Robustness, LagsOfResidualTestsAreThoseOfTheirRow) {
  refuses([&] { patch_cell(path, "/residual_tests/lags", "lag", 0, 4); }, "lag 4 of global");
  refuses([&] { patch_cell(path, "/residual_tests/lags", "lag", 0, -1); }, "-1");
  refuses([&] { patch_cell(path, "/residual_tests/runs", "lags", 0, 5); }, "another number of rows");
}

TEST_F(Robustness, OnlyVerificationJudgesValues) {
  patch_number(path, "/mixture/covariances", 1, 1e3);
  EXPECT_THAT(verify_archive(path).problems, Contains(HasSubstr("/mixture/covariances: holds a matrix")));
  EXPECT_NO_THROW(read_archive(path));
  EXPECT_NO_THROW(read_archive(path, Evaluations::in_file));
}

/// The layout that h5repack makes.
TEST_F(Robustness, ArraysInChunksAreRead) {
  replace_by_chunks(path, "/bank/A", {3, 2, 2});
  EXPECT_THAT(verify_archive(path).problems, ::testing::IsEmpty());
  EXPECT_NO_THROW(read_archive(path));
}

TEST_F(Robustness, ArraysInOtherFilesAndOtherHdf5AreRefused) {
  refuses([&] { replace_by_external(path, "/bank/A", "elsewhere"); }, "has its content in another file");
  write_foreign_hdf5(path, 512);
  sign(path);
  expect_unreadable("not a modebank archive (root attribute format is '')");
}

TEST_F(Robustness, D2AModelThatCannotStepIsNotLoaded) {
  patch_number_attribute(path, "/drifting", "lam", 2.0);
  EXPECT_THAT([&] { load_bank(path, "drifting"); }, ThrowsMessage<DataError>(HasSubstr("lam in [0, 1]")));
}

TEST_F(Robustness, D11TheHashIsCheckedBeforeAnythingIsShown) {
  std::string bytes = read_file(path);
  bytes[bytes.size() - 9] ^= 1;
  write_file(path, bytes);
  for (const auto& look : std::vector<std::function<void()>>{
           [&] { inspect(path, "/"); }, [&] { read_trial_scores(path); }, [&] { load_configuration(path); }})
    EXPECT_THAT(look, ThrowsMessage<DataError>(HasSubstr("damaged: the content's SHA-256")));
}

TEST_F(Robustness, D12WhatIsNoRegularFileIsNotRead) {
  const fs::path link = folder.path() / "link.h5";
  fs::create_symlink("/dev/zero", link);
  EXPECT_THAT(verify_archive(link).problems, Contains(HasSubstr("not a regular file")));
  EXPECT_THAT([&] { read_archive(link); }, ThrowsMessage<DataError>(HasSubstr("not a regular file")));
  fs::remove(link);
  fs::create_symlink("link.h5", link);
  EXPECT_THAT(verify_archive(link).problems, Contains(HasSubstr("symbolic links")));
  EXPECT_THAT([&] { read_archive(link); }, ThrowsMessage<DataError>(HasSubstr("link.h5: ")));
}

}  // namespace
}  // namespace modebank::test
