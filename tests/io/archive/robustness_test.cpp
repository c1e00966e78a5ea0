// Archives that another program made to harm: whatever reads them says what is wrong, and nothing else happens.
#include <cmath>
#include <limits>

#include "io/archive/bank/load_bank.hpp"
#include "io/archive/inspect.hpp"
#include "io/archive/study_file.hpp"
#include "tests/io/archive/archive_file_fixture.hpp"
#include "tests/io/archive/archive_patch.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

class Robustness : public ArchiveFile {
 protected:
  /// Afterwards the archive is whole again.
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
  refuses_number("/evaluation/bank/10/viterbi_mode", 2, 3, "viterbi_mode: holds 3 at (2), must lie in -1 .. 2");
  refuses_number("/evaluation/baseline/10/free_run_mode", 0, 1, "free_run_mode: holds 1 at (0), must lie in -1 .. 0");
  refuses_number("/windows/start", 0, -1e6, "/windows/start: holds");
  refuses_number("/windows/start", 0, 1e6, "reaches beyond run");
  refuses_number("/windows/rank", 0, 9, "/windows/rank: holds 9 at (0), must lie in 0 .. 8");
  refuses_number("/data/10/label", 0, 2, "beyond the 2 label_names");
  refuses([&] { patch_cell(path, "/evaluation/diagnostics", "mode", 1, 3); }, "column 'mode' holds 3 at (1)");
  refuses([&] { patch_cell(path, "/evaluation/confusion", "mode", 0, -1); }, "column 'mode' holds -1");
  refuses([&] { patch_cell(path, "/evaluation/summary", "samples", 0, -5); }, "column 'samples' holds -5");
}

TEST_F(Robustness, D2NumbersOfAModelThatCannotBe) {
  for (const double dt_s : {-0.1, 0.0, nan, infinity}) refuses_attribute("/bank", "dt_s", dt_s);
  for (const double forgetting : {nan, -0.5, 1.5}) refuses_attribute("/bank", "noise_forgetting", forgetting);
  for (const double samples : {nan, 0.0, infinity}) refuses_attribute("/bank", "noise_prior_samples", samples);
  refuses_attribute("/bank", "inputs", std::ldexp(1.0, 62));
  refuses_attribute("/bank", "input_lags", 1e9);
  refuses_attribute("/drifting", "dt_s", 0.0);
  for (const double value : {nan, infinity}) {
    refuses_number("/bank/A", 0, value, "/bank/A: holds");
    refuses_number("/bank/B", 1, value, "/bank/B: holds");
    refuses_number("/bank/c", 1, value, "/bank/c: holds");
  }
  refuses_number("/drifting/parameters", 0, nan, "drifting");
}

TEST_F(Robustness, D2MatricesThatAreNoCovariances) {
  for (const double variance : {-1.0, nan, infinity}) {
    refuses_number("/bank/Q", 0, variance, "/bank/Q: holds");
    refuses_number("/baseline/R", 3, variance, "/baseline/R: holds");
  }
  refuses_number("/bank/Q", 1, 0.5, "/bank/Q: holds a matrix at (0, 0, 0) that is no covariance");  // not symmetric
  refuses(
      [&] {
        patch_number(path, "/bank/Q", 5, 50.0);
        patch_number(path, "/bank/Q", 6, 50.0);
      },
      "/bank/Q: holds a matrix at (1, 0, 0) that is no covariance");  // not definite
  refuses_number("/mixture/covariances", 1, 1e3, "/mixture/covariances: holds a matrix");
}

TEST_F(Robustness, D2ProbabilitiesThatDoNotSumToOne) {
  refuses_number("/bank/transition", 0, 2.0, "/bank/transition: holds 2");
  refuses_number("/bank/transition", 0, 0.5, "/bank/transition: holds probabilities that sum to 0.8");
  refuses_number("/bank/initial_probability", 0, 0.0, "/bank/initial_probability: holds probabilities");
  refuses_number("/mixture/weights", 0, 0.1, "the weights sum to");
  refuses_number("/mixture/responsibilities", 0, 1.5, "/mixture/responsibilities: holds 1.5");
}

TEST_F(Robustness, D2TimesAndNamesThatCannotBe) {
  refuses_number("/data/10/time", 3, -1.0, "/data/10/time: does not increase at (3)");
  refuses_number("/data/10/time", 3, nan, "/data/10/time: holds nan");
  refuses_number("/data/10/state", 3, infinity, "/data/10/state: holds inf");
  refuses([&] { patch_text_attribute(path, "/bank", "model", "lin\x1b[2Jear"); }, "control characters");
  refuses(
      [&] {
        replace_by_zeros(path, "/evaluation/bank/10/mode_probability", {14, 2}, Kind::real);
      },
      "mode_probability: has shape (14, 2), but K is 3");
}

TEST_F(Robustness, ComputedSpreadsSharesAndAmountsThatCannotBe) {
  for (const std::string spread :
       {"/windows/covariance", "/windows/global/covariance", "/windows/global/residual_covariance",
        "/bank/parameter_covariance", "/evaluation/bank/10/covariance", "/evaluation/bank/10/innovation_covariance",
        "/evaluation/bank/10/smoothed_covariance"})
    refuses_number(spread, 0, -1.0, spread + ": holds a matrix at (0");
  refuses_number("/windows/covariance", 1, 1e6, "that is no covariance");  // not symmetric
  for (const std::string error :
       {"/windows/standard_error", "/windows/global/noise_variance", "/mixture/weights_standard_error",
        "/mixture/means_standard_error", "/bank/parameter_standard_error", "/bank/Q_standard_error",
        "/bank/R_standard_error", "/bank/transition_standard_error", "/bank/transition_weight_standard_error",
        "/evaluation/bank/10/free_run_sd", "/residual_tests/bank/10/cross_correlation_band"})
    refuses_number(error, 0, -0.5, error + ": holds -0.5 at (0");
  for (const std::string share : {"/evaluation/bank/10/spread_share", "/residual_tests/bank/10/ljung_box_p"})
    refuses_number(share, 1, 1.5, share + ": holds 1.5 at (1");
  refuses_number("/windows/r_squared", 2, 1.5, "/windows/r_squared: holds 1.5");
  for (const std::string column : {"coverage_95", "too_far", "whiteness_p", "nis_mean"})
    refuses([&] { patch_cell(path, "/evaluation/summary", column, 1, -0.5); }, "holds -0.5 at (1)");
  refuses([&] { patch_cell(path, "/evaluation/diagnostics", "usage", 0, 2.0); }, "column 'usage' holds 2 at (0)");
  refuses([&] { patch_cell(path, "/lag/runs", "lag_standard_error_s", 0, -1.0); }, "holds -1 at (0)");
}

TEST_F(Robustness, ProbabilitiesOfModesThatDoNotSumToOne) {
  refuses_number("/evaluation/bank/10/mode_probability", 1, 0.9, "mode_probability: holds probabilities that sum to");
  refuses_number("/evaluation/bank/10/mode_probability_predicted", 0, 0.9, "holds probabilities that sum to");
  refuses_number("/mixture/responsibilities", 0, 0.999, "responsibilities: holds probabilities that sum to");
  patch_number(path, "/evaluation/bank/10/mode_probability", 1, nan);  // not known
  EXPECT_NO_THROW(read_archive(path));
}

TEST_F(Robustness, CountsOfMoreThanThereIs) {
  for (const std::string table : {"summary", "horizon", "free_run", "diagnostics", "confusion", "evidence/gains"})
    refuses([&] { patch_cell(path, "/evaluation/" + table, "samples", 0, 40); }, "must lie in 0 .. 39");
  refuses_attribute("/residual_tests/bank/10", "samples", 15);
  refuses_attribute("/mixture", "clustered_windows", 10);
  refuses_attribute("/windows/global", "transitions", 40);
  refuses_attribute("/bank", "learned_transitions", -1);
  refuses([&] { patch_number_attribute(path, "/windows", "audit_ceres_windows", 1e9); },
          "the audit counts 1000000000 of");
  refuses_number("/windows/transitions", 0, 6, "/windows/transitions: holds 6 at (0), must lie in 0 .. 5");
  refuses([&] { patch_number_attribute(path, "/evaluation/evidence", "runs", 4); }, "speaks of 4 runs, there are 3");
  refuses([&] { patch_number_attribute(path, "/evaluation/evidence", "modes", 4); }, "speaks of 4 modes, there are 3");
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
  names("/data", "runs", 0, "10", "two runs are named \"10\"");
  names("/evaluation", "filters", 1, "bank", "filters names 'bank' twice");
  names("/residual_tests", "models", 1, "global", "models names 'global' twice");
  names("/data", "label_names", 0, "snow", "confusion names the unknown label 'ice'");
  refuses([&] { patch_text_attribute(path, "/evaluation/evidence", "best_competitor", "../x"); },
          "evidence names the unknown filter '../x'");
}

/// What an overview leaves out, and what a robot's filter does not need, is judged all the same.
TEST_F(Robustness, EveryReaderJudgesTheWholeArchive) {
  const std::vector<std::pair<std::string, std::function<void()>>> readers{
      {"overview", [&] { read_overview(path, 1); }},
      {"by runs", [&] { read_archive_by_runs(path, 0); }},
      {"judged alone", [&] { judge_archive(path); }},
      {"whole", [&] { read_archive(path); }}};
  const std::vector<std::function<void()>> changes{
      [&] { patch_number(path, "/evaluation/baseline/10/free_run_mode", 0, 1); },
      [&] { patch_number(path, "/evaluation/bank/10/viterbi_mode", 2, 3); },
      [&] { patch_number(path, "/residual_tests/global/10/ljung_box_p", 0, 2); },
      [&] { patch_number(path, "/windows/status", 3, 255); },
      [&] { link_to_file(path, "/extra", "/etc/passwd"); },
      [&] {
        craft(path, [](hid_t file) {
          H5Gclose(H5Gcreate2(file, "/mine", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
          H5Lcreate_external("a.h5", "/", file, "/mine/far", H5P_DEFAULT, H5P_DEFAULT);
        });
      }};
  for (const auto& change : changes) {
    change();
    EXPECT_FALSE(verify_archive(path).ok());
    for (const auto& [name, read] : readers) EXPECT_THROW(read(), DataError) << name;
    write_archive(path, full_archive(2, 1));
  }
  for (const auto& [name, read] : readers) EXPECT_NO_THROW(read()) << name;
}

/// HDF5's indices of chunks, its filters and its older headers are not reached by way of an archive.
/// As h5repack lays them out.
TEST_F(Robustness, ArraysInChunksAreRead) {
  replace_by_chunks(path, "/bank/A", {3, 2, 2});
  EXPECT_THAT(verify_archive(path).problems, ::testing::IsEmpty());
  EXPECT_NO_THROW(read_archive(path));
}

TEST_F(Robustness, ArraysInOtherFilesAndOtherHdf5AreRefused) {
  refuses([&] { replace_by_external(path, "/bank/A", "elsewhere"); }, "keeps its content in another file");
  write_foreign_hdf5(path, 512);
  sign(path);
  expect_unreadable("not a modebank archive (root attribute format is '')");
}

TEST_F(Robustness, D2ABankAloneIsJudgedAlike) {
  patch_number_attribute(path, "/bank", "dt_s", -0.1);
  EXPECT_THAT([&] { load_bank(path); }, ThrowsMessage<DataError>(HasSubstr("/bank/dt_s: holds -0.1")));
  patch_number_attribute(path, "/drifting", "lam", 2.0);
  EXPECT_THAT([&] { load_drifting(path); }, ThrowsMessage<DataError>(HasSubstr("lam lies in [0, 1]")));
}

TEST_F(Robustness, D11LinksThatLeaveTheArchiveOrComeBack) {
  write_archive(folder.path() / "other.h5", full_archive(2, 1));
  for (const std::string member : {"/data", "/bank/A", "/bank", "/windows/parameters", "/evaluation/bank/10/pit"}) {
    refuses([&] { link_to_file(path, member, "other.h5"); }, "is a link to another place");
    refuses([&] { link_to_place(path, member, "/config", false); }, "is a link to another place");
  }
  link_to_file(path, "/bank", "other.h5");
  EXPECT_THAT([&] { load_bank(path); }, ThrowsMessage<DataError>(HasSubstr("is a link to another place")));
  write_archive(path, full_archive(2, 1));
  refuses([&] { link_to_place(path, "/baseline", "/bank", true); }, "several names");
  refuses([&] { link_to_place(path, "/bank/A", "/baseline/A", true); }, "several names");
}

TEST_F(Robustness, D11VerificationLooksAtWhatNobodyReads) {
  const auto finds = [&](const std::string& reason) {
    EXPECT_THAT(verify_archive(path).problems, Contains(HasSubstr(reason)));
    write_archive(path, full_archive(2, 1));
  };
  link_to_file(path, "/extra", "/etc/passwd");
  finds("/extra: is a link to another place");
  craft(path, [](hid_t file) {
    H5Gclose(H5Gcreate2(file, "/mine", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Lcreate_external("a.h5", "/", file, "/mine/far", H5P_DEFAULT, H5P_DEFAULT);
  });
  finds("/mine: is a link to another place");
  link_to_place(path, "/bank/loop", "/", true);
  finds("several names");
}

/// /trials of a study's table lead to its trials, and to nothing else.
TEST_F(Robustness, D11AStudyLinksToItsTrialsAlone) {
  const fs::path table = folder.path() / "study.h5";
  const std::string key(64, 'a');
  const auto links = [&](const std::string& file) {
    write_study_file(table,
                     {full_archive(2, 1).provenance, "", "study", {{"key", std::vector<std::string>{key}}}, {}, {}});
    link_to_file(table, "/trials/" + key, file);
    return verify_archive(table).problems;
  };
  EXPECT_THAT(links("trials/" + key + ".h5"), ::testing::IsEmpty());
  EXPECT_NO_THROW(read_study_file(table, "study"));
  for (const std::string& file :
       std::vector<std::string>{"trials/../secret.h5", "/etc/" + key + ".h5", "trials/short.h5", "../trials/x.h5"})
    EXPECT_THAT(links(file), Contains(HasSubstr("is a link to another place"))) << file;
  EXPECT_THAT([&] { read_study_file(table, "study"); }, ThrowsMessage<DataError>(HasSubstr("another place")));
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
  EXPECT_THAT(hash_problems(link), Contains(HasSubstr("not a regular file")));
  EXPECT_THAT([&] { read_archive(link); }, ThrowsMessage<DataError>(HasSubstr("not a regular file")));
  fs::remove(link);
  fs::create_symlink("link.h5", link);
  EXPECT_THAT(hash_problems(link), Contains(HasSubstr("cannot open the file")));
  EXPECT_THAT([&] { read_archive(link); }, ThrowsMessage<DataError>(HasSubstr("link.h5: ")));
}

}  // namespace
}  // namespace modebank::test
