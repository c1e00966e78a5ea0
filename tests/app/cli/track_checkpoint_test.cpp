// Checkpoints of the live filter, tested through the program.
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/archive/archive.hpp"
#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class TrackCheckpoint : public Track {
 protected:
  /// Sends samples `first` to `last` - 1 of a run after the header, and appends the answers. `ending`: a signal, or 0
  /// to end the input.
  void feed(const std::vector<std::string>& options, std::size_t first, std::size_t last, int ending,
            std::vector<std::string>& answers) const {
    const std::vector<std::string> samples = lines("run_01.csv");
    PipedProgram program(command(options));
    program.write(samples[0] + "\n");
    program.read_line();
    for (std::size_t k = first; k < last; ++k) {
      program.write(samples[k] + "\n");
      answers.push_back(program.read_line().value());
    }
    if (ending != 0)
      program.send_signal(ending);
    else
      program.close_input();
    const int status = program.wait();
    EXPECT_TRUE(status == 0 || ending == SIGKILL) << program.errors();
  }

  std::string checkpoint() const { return file("state.json").string(); }

  /// noise_only has several modes; this gives it state-dependent transition probabilities.
  void give_noise_only_a_logit() const {
    Archive stored = read_archive(archive());
    Bank& bank = *stored.noise_only;
    ASSERT_GT(bank.mode_count(), 1);
    const Index d = bank.structure.dimension() + bank.structure.acting_inputs();
    Eigen::MatrixXd weights(bank.mode_count(), d);
    for (Index i = 0; i < weights.size(); ++i) weights.data()[i] = 3.0 * std::sin(static_cast<double>(i + 1));
    bank.transition_logit = {weights, Eigen::VectorXd::Constant(d, 0.05)};
    write_archive(archive(), stored);
  }
};

TEST_F(TrackCheckpoint, RefusesCheckpointsThatNoFilterWrote) {
  const std::vector<std::string> samples = lines("run_01.csv");
  const std::string checkpoint = file("state.json").string();
  {
    PipedProgram program(command({"--track.checkpoint", checkpoint}));
    for (std::size_t k = 0; k < 5; ++k) program.write(samples[k] + "\n");
    program.close_input();
    EXPECT_EQ(program.wait(), 0);
  }
  std::ifstream stream(checkpoint);
  const json good = json::parse(stream);
  EXPECT_EQ(modebank({"track", archive(), "--track.resume", checkpoint}).status, 0);
  const auto resume = [&](const char* key, const json& value) {
    json bad = good;
    bad[json::json_pointer(key)] = value;
    write("bad.json", bad.dump());
    const ProgramResult result = modebank({"track", archive(), "--track.resume", file("bad.json").string()});
    EXPECT_EQ(result.status, 1) << key << result.err;
    EXPECT_THAT(result.err, HasSubstr("bad.json")) << key;
  };
  resume("/means/rows", -1);
  resume("/means/rows", 1e18);
  resume("/means/columns", json::array());
  resume("/inputs/columns/0/0", json());
  resume("/mode_probability/columns/0/0", -0.5);
  resume("/noise_scale", 0.0);
  resume("/time_s", json());
  resume("/samples", -3);
  resume("/started", "yes");
  resume("/format", "something else");
}

/// The process is killed right after a checkpoint was due. The next process must continue with identical results.
TEST_F(TrackCheckpoint, GoesOnAfterItWasKilledWhereSwitchesSeeStateAndInput) {
  const std::string option = "--track.filter", filter = "noise_only";
  std::vector<std::string> constant, whole, parts;
  feed({option, filter}, 1, 40, 0, constant);
  give_noise_only_a_logit();
  feed({option, filter}, 1, 40, 0, whole);
  EXPECT_NE(whole, constant);
  feed({option, filter, "--track.checkpoint", checkpoint(), "--track.checkpoint_interval", "10"}, 1, 12, SIGKILL,
       parts);
  ASSERT_TRUE(std::filesystem::exists(checkpoint()));
  parts.resize(10);
  feed({option, filter, "--track.resume", checkpoint()}, 11, 40, 0, parts);
  EXPECT_EQ(parts, whole);
}

}  // namespace
}  // namespace modebank::test
