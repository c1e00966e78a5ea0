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
          3,
          {"--time=60"}};
}

TEST(StudySlurmScript, JobsThatWereGivenStay) {
  SlurmRequest with_jobs = request();
  with_jobs.overrides.emplace_back("study.jobs", "4");
  EXPECT_EQ(run_script(with_jobs).find("SLURM_CPUS_PER_TASK"), std::string::npos);
}

/// A shell converts the quoted word back to the word.
TEST(StudySlurmScript, ShellWordsComeBackAsTheyWere) {
  for (const std::string word : {"plain", "two words", "it's", "$HOME", "a\"b", "back\\slash", "", "{1..3} | *"})
    EXPECT_EQ(run_shell("printf %s " + shell_word(word)).out, word);
}

/// A fake of sbatch that prints given texts.
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
                       "/%A_%a.log><--array=1-3><--time=60><" + slurm +
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

}  // namespace
}  // namespace modebank::app
