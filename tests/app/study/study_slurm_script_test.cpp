#include <gtest/gtest.h>

#include <boost/algorithm/string.hpp>
#include <cstdlib>

#include "app/study/launch/shell.hpp"
#include "app/study/launch/slurm.hpp"
#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app {
namespace {

SlurmRequest request() {
  return {"/opt/modebank",
          "/home/me/my study.ini",
          "/scratch/ice.study",
          "/data",
          {{"study.vary", "bank.stay = 0.9 | 0.95"}, {"study.stage", "submit"}},
          7,
          {0, 1, 2},
          {"--time=60"}};
}

TEST(StudySlurmScript, JobsThatWereGivenStay) {
  SlurmRequest with_jobs = request();
  with_jobs.overrides.emplace_back("study.jobs", "4");
  EXPECT_EQ(run_script(with_jobs).find("SLURM_CPUS_PER_TASK"), std::string::npos);
}

TEST(StudySlurmScript, ArrayListsNameRanges) {
  EXPECT_EQ(array_list({0, 1, 2, 3}), "0-3");
  EXPECT_EQ(array_list({1, 4, 5, 9}), "1,4-5,9");
}

/// A shell converts the quoted word back to the word.
TEST(StudySlurmScript, ShellWordsComeBackAsTheyWere) {
  for (const std::string word : {"plain", "two words", "it's", "$HOME", "a\"b", "back\\slash", "", "{1..3} | *"})
    EXPECT_EQ(run_shell("printf %s " + shell_word(word)).out, word);
}

/// Fakes of sbatch, squeue and sacct that print given texts.
class FakeSlurm : public ::testing::Test {
 protected:
  FakeSlurm() : before_(std::getenv("PATH")) { setenv("PATH", (folder_.path().string() + ":" + before_).c_str(), 1); }
  ~FakeSlurm() override { setenv("PATH", before_.c_str(), 1); }
  void program(const std::string& name, const std::string& body) const {
    test::write_file(folder_.path() / name, "#!/bin/sh\n" + body + "\n");
    std::filesystem::permissions(folder_.path() / name, std::filesystem::perms::owner_all);
  }
  SlurmSubmission submit() const {
    SlurmRequest wanted = request();
    wanted.folder = study();
    return submit_to_slurm(wanted);
  }
  std::filesystem::path study() const { return folder_.path() / "ice.study"; }

  test::TemporaryFolder folder_;

 private:
  std::string before_;
};

/// D10 of the review: a path was read as lines of the script, as a pattern, or as several words.
TEST_F(FakeSlurm, NoPathStandsWhereSlurmReadsIt) {
  program("sbatch", "for word; do printf '<%s>' \"$word\"; done >> \"$0.words\"; echo 41");
  SlurmRequest wanted = request();
  wanted.folder = study() / "it's 100 %j \"odd\"";
  const SlurmSubmission submission = submit_to_slurm(wanted);
  const std::string words = read_file(folder_.path() / "sbatch.words");
  const std::string slurm = (wanted.folder / "slurm").string();
  const std::string logs = boost::replace_all_copy(slurm, "%", "%%");
  EXPECT_EQ(words, "<--parsable><--job-name=run-it_s_100__j__odd_><--output=" + logs +
                       "/%A_%a.log><--array=0-2><--time=60><" + slurm +
                       "/run.sh><--parsable><--job-name=merge-it_s_100__j__odd_><--output=" + logs +
                       "/%j.log><--dependency=afterany:41><--time=60><" + slurm + "/merge.sh>");
  EXPECT_EQ(submission.array_job, "41");
  for (const std::string& script : {run_script(wanted), merge_script(wanted)})
    for (std::size_t at = script.find("#SBATCH"); at != std::string::npos; at = script.find("#SBATCH", at + 1))
      EXPECT_EQ(script.substr(at, script.find('\n', at) - at).find("odd"), std::string::npos) << script;
}

TEST_F(FakeSlurm, ControlCharactersInPathsAreRefusedBeforeAnythingIsWritten) {
  program("sbatch", "echo 41");
  SlurmRequest wanted = request();
  wanted.folder = study() / "new\ntouch pwned";
  try {
    submit_to_slurm(wanted);
    ADD_FAILURE() << "was not refused";
  } catch (const ConfigurationError& error) {
    EXPECT_NE(std::string(error.what()).find("new\\ntouch pwned"), std::string::npos) << error.what();
  }
  wanted.folder = study() / "back\\slash";
  EXPECT_THROW(submit_to_slurm(wanted), ConfigurationError);
  EXPECT_FALSE(std::filesystem::exists(study()));
}

TEST_F(FakeSlurm, StatusJoinsQueueAndAccounting) {
  program("sbatch", "case \"$*\" in *afterany*) echo 42;; *) echo 41;; esac");
  submit();
  program("squeue",
          "case \"$*\" in *'-j 41'*) echo '41_1|RUNNING|None'; "
          "echo '41_2|PENDING|launch failed requeued held';; *) echo Invalid job id; exit 1;; esac");
  program("sacct",
          "case \"$*\" in *'-j 41'*) echo '41_0|COMPLETED'; echo '41_1|PENDING'; echo '41_[2-3]|PENDING';; "
          "*) exit 1;; esac");
  const std::vector<SlurmJobView> jobs = slurm_view(study());
  ASSERT_EQ(jobs.size(), 2U);
  using States = std::vector<std::pair<std::string, int>>;
  EXPECT_EQ(jobs[0].states, (States{{"COMPLETED", 1}, {"PENDING", 1}, {"RUNNING", 1}}));
  ASSERT_EQ(jobs[0].notes.size(), 1U);
  EXPECT_NE(jobs[0].notes[0].find("scontrol release 41_2"), std::string::npos);
  EXPECT_TRUE(jobs[1].states.empty());
  const std::string text = slurm_text(jobs);
  EXPECT_NE(text.find("run job 41: 1 completed 1 pending 1 running (squeue and sacct)"), std::string::npos) << text;
  EXPECT_NE(text.find("merge job 42: no longer listed by Slurm"), std::string::npos) << text;
}

TEST_F(FakeSlurm, NoSubmissionNoView) { EXPECT_TRUE(slurm_view(study()).empty()); }

}  // namespace
}  // namespace modebank::app
