// Banks are read from archives, and archives are made again. The numbers must be equal each time.
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

namespace modebank::test {
namespace {

/// All numbers of an archive below `path`, as text from which the same numbers can be read back.
std::string numbers_of(const std::string& archive, const std::string& path) {
  const nlohmann::json object = inspect(archive, path);
  if (!object.contains("members")) return path + object.at("value").dump() + "\n";
  std::string text = path + object.at("attributes").dump() + "\n";
  for (const auto& [name, member] : object.at("members").items())
    text += numbers_of(archive, (path == "/" ? "" : path) + "/" + name);
  return text;
}

std::string all_stages(const std::string& archive) {
  std::string text;
  for (const char* stage : {"/data", "/windows", "/mixture", "/bank", "/baseline", "/noise_only", "/one_motion",
                            "/drifting", "/evaluation", "/evaluation/evidence", "/residual_tests"})
    text += numbers_of(archive, stage);
  return text;
}

class StoredStages : public CliTest {};

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

TEST_F(StoredStages, StoredBankGivesBitIdenticalScores) {
  ASSERT_EQ(run().status, 0);
  const std::string again = file("again.h5").string();
  const ProgramResult result = modebank({"run", config(), "--archive.bank", archive(), "--archive.output", again});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(numbers_of(again, "/evaluation"), numbers_of(archive(), "/evaluation"));
  EXPECT_EQ(numbers_of(again, "/bank"), numbers_of(archive(), "/bank"));
}

/// For any stored bank, the filter kf is the global model.
TEST_F(StoredStages, AStoredBankRunAsOneKalmanFilterIsTheBaseline) {
  ASSERT_EQ(run({"--mixture.components", "3"}).status, 0);
  const std::string again = file("again.h5").string();
  const ProgramResult result =
      modebank({"run", config(), "--archive.bank", archive(), "--archive.output", again, "--filter.variant", "kf"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive content = read_archive(again);
  EXPECT_EQ(content.bank->mode_count(), 1);
  EXPECT_EQ(content.evaluations.at(0).runs.at(0).log_density.tail(70),
            content.evaluations.at(1).runs.at(0).log_density.tail(70));
}

/// A chain that ends early writes the same numbers of its stages, and never over an archive that holds more.
TEST_F(StoredStages, StagesUntilOneGiveWhatRunGives) {
  ASSERT_EQ(run().status, 0);
  const std::string part = file("part.h5").string();
  const std::vector<std::string> groups{"/windows", "/mixture", "/bank"};
  for (const std::size_t last : {0u, 1u, 2u}) {
    const std::string until = groups[last].substr(1);
    ASSERT_EQ(modebank({"run", config(), "--until", until, "--archive.output", part}).status, 0) << until;
    for (std::size_t k = 0; k <= last; ++k) EXPECT_EQ(numbers_of(part, groups[k]), numbers_of(archive(), groups[k]));
    const Archive found = read_archive(part);
    EXPECT_EQ(found.mixture.has_value(), last >= 1);
    EXPECT_EQ(found.bank.has_value(), last >= 2);
    EXPECT_TRUE(found.evaluations.empty());
    EXPECT_EQ(modebank({"run", config(), "--until", until, "--archive.output", archive()}).status, 1)
        << "would replace the whole run's archive";
  }
}

TEST_F(StoredStages, AStoredBankLeavesItsTraceAndIsNotHeldOutOnItsTrainingRuns) {
  ASSERT_EQ(run().status, 0);
  const std::string again = file("again.h5").string();
  const ProgramResult result = modebank({"run", config(), "--archive.bank", archive(), "--archive.output", again,
                                         "--data.train", "01", "--data.test", "00"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, ::testing::HasSubstr("its bank was trained on 00"));
  EXPECT_EQ(read_archive(again).provenance.inputs.back().sha256, sha256_hex(read_file(archive())));
}

}  // namespace
}  // namespace modebank::test
