// Stages and banks are read from archives, and archives are made again. The numbers must be equal each time.
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "app/chain/chain.hpp"
#include "app/config/config_file.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/inspect.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/support/archive_text.hpp"

namespace modebank::test {
namespace {

class StoredStages : public CliTest {};

TEST_F(StoredStages, NumbersAreTheSameForAnyThreadCount) {
  ASSERT_EQ(run({"--job.threads", "1"}).status, 0);
  const std::string one = all_stages(archive());
  ASSERT_EQ(run({"--job.threads", "2"}).status, 0);
  EXPECT_EQ(all_stages(archive()), one);
}

/// The archive of `run` if it learns from `transitions` training transitions. 0 means all.
Archive learned_from(const std::string& config, Index transitions, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  ChainOptions options = chain_options(app::load_config(config, {}));
  options.bank.em.transitions = transitions;
  StageSource none;
  const Listener silent;
  return Chain(none, silent).run(options, Stage::bank_scores, {});
}

TEST_F(StoredStages, LearningFromAPartIsTheSameForAnyThreadCountAndSaysSo) {
  const std::string one = file("one.h5").string(), two = file("two.h5").string();
  write_archive(one, learned_from(config(), 60, 1));
  EXPECT_EQ(read_archive(one).learned_transitions, 60);
  EXPECT_THAT(modebank({"show", one}).out, ::testing::HasSubstr("learned   from 60 of 79 training transitions"));
  write_archive(two, learned_from(config(), 60, 2));
  EXPECT_EQ(all_stages(two), all_stages(one));
}

TEST_F(StoredStages, ALimitOfAllTransitionsChangesNothing) {
  const std::string all = file("all.h5").string(), limit = file("limit.h5").string();
  write_archive(all, learned_from(config(), 0, 2));
  write_archive(limit, learned_from(config(), 79, 2));
  EXPECT_EQ(all_stages(limit), all_stages(all));
}

/// Recordings whose evaluations exceed the memory are written in this way.
TEST_F(StoredStages, EvaluationsWrittenAsTheyAreMadeAreTheSame) {
  ASSERT_EQ(run().status, 0);
  const std::string streamed = file("streamed.h5").string();
  const ChainOptions options = app::chain_options(app::load_config(config(), {}));
  StageSource computed;
  const Listener silent;
  Chain chain(computed, silent);
  const Recording& recording = *chain.run(options, Stage::data, {}).recording;
  write_archive(streamed, recording, [&](const EvaluationSink& sink) -> const Archive& {
    return chain.run(options, Stage::bank_scores, {}, &sink);
  });
  EXPECT_EQ(all_stages(streamed), all_stages(archive()));
}

TEST_F(StoredStages, StoredConfigurationReproducesTheArchive) {
  ASSERT_EQ(run().status, 0);
  const Archive first = read_archive(archive());
  const std::string numbers = all_stages(archive());
  write("test.ini", first.config);
  ASSERT_EQ(modebank({"run", config()}).status, 0);
  EXPECT_EQ(all_stages(archive()), numbers);
  EXPECT_EQ(read_archive(archive()).provenance.config_hash, first.provenance.config_hash);
}

TEST_F(StoredStages, StoredBankGivesBitIdenticalScores) {
  ASSERT_EQ(run().status, 0);
  const std::string again = file("again.h5").string();
  const ProgramResult result = modebank({"evaluate", config(), "--archive.bank", archive(), "--archive.output", again});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(numbers_of(again, "/evaluation"), numbers_of(archive(), "/evaluation"));
  EXPECT_EQ(numbers_of(again, "/bank"), numbers_of(archive(), "/bank"));
}

/// For any stored bank, the filter kf is the global model.
TEST_F(StoredStages, AStoredBankRunAsOneKalmanFilterIsTheBaseline) {
  ASSERT_EQ(run({"--mixture.components", "3"}).status, 0);
  const std::string again = file("again.h5").string();
  const ProgramResult result = modebank(
      {"evaluate", config(), "--archive.bank", archive(), "--archive.output", again, "--filter.variant", "kf"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive content = read_archive(again);
  EXPECT_EQ(content.bank->mode_count(), 1);
  EXPECT_EQ(content.evaluations.at(0).runs.at(0).log_density.tail(70),
            content.evaluations.at(1).runs.at(0).log_density.tail(70));
}

TEST_F(StoredStages, StagesOneByOneGiveWhatRunGives) {
  ASSERT_EQ(run().status, 0);
  const std::string a = file("a.h5").string(), b = file("b.h5").string(), c = file("c.h5").string();
  ASSERT_EQ(modebank({"identify", config(), "--archive.output", a}).status, 0);
  EXPECT_FALSE(read_archive(a).mixture.has_value());
  ASSERT_EQ(modebank({"cluster", config(), "--archive.input", a, "--archive.output", b}).status, 0);
  EXPECT_FALSE(read_archive(b).bank.has_value());
  ASSERT_EQ(modebank({"evaluate", config(), "--archive.input", b, "--archive.output", c}).status, 0);
  EXPECT_EQ(all_stages(c), all_stages(archive()));
}

TEST_F(StoredStages, StoredStagesMustBeAsConfigured) {
  ASSERT_EQ(run().status, 0);
  const std::string again = file("again.h5").string();
  const auto refusal = [&](const char* command, const char* key, const char* value) {
    const ProgramResult result = modebank({command, config(), "--data.root", file(".").string(), "--archive.input",
                                           archive(), "--archive.output", again, key, value});
    EXPECT_EQ(result.status, 2) << key;
    EXPECT_THAT(result.err, ::testing::HasSubstr(key + 2)) << "without the dashes";
    EXPECT_FALSE(std::filesystem::exists(again));
  };
  refusal("cluster", "--window.length", "30");
  refusal("evaluate", "--mixture.components", "1");
  refusal("identify", "--data.train", "01");
  const ProgramResult replaced =
      modebank({"cluster", config(), "--archive.input", archive(), "--archive.output", archive()});
  EXPECT_EQ(replaced.status, 2) << "an archive must not replace its source";
}

TEST_F(StoredStages, DamagedBanksAreNotRun) {
  ASSERT_EQ(run().status, 0);
  std::string bytes = read_file(archive());
  bytes[bytes.size() - 9] = static_cast<char>(bytes[bytes.size() - 9] ^ 1);
  write("damaged.h5", bytes);
  const ProgramResult result = modebank({"evaluate", config(), "--archive.bank", file("damaged.h5").string(),
                                         "--archive.output", file("again.h5").string()});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, ::testing::HasSubstr("SHA-256"));
}

TEST_F(StoredStages, AStoredBankLeavesItsTraceAndIsNotHeldOutOnItsTrainingRuns) {
  ASSERT_EQ(run().status, 0);
  const std::string again = file("again.h5").string();
  const ProgramResult result = modebank({"evaluate", config(), "--archive.bank", archive(), "--archive.output", again,
                                         "--data.train", "01", "--data.test", "00"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, ::testing::HasSubstr("its bank was trained on 00"));
  EXPECT_EQ(read_archive(again).provenance.inputs.back().sha256, sha256_hex(read_file(archive())));
}

}  // namespace
}  // namespace modebank::test
