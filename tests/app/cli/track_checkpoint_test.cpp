// The live filter's checkpoints from outside.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class TrackCheckpoint : public Track {};

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

TEST_F(TrackCheckpoint, GoesOnFromACheckpointAsIfItHadNeverStopped) {
  const std::vector<std::string> samples = lines("run_01.csv");
  std::vector<std::string> whole, parts;
  const auto feed = [&](const std::vector<std::string>& options, std::size_t first, std::size_t last, bool interrupt,
                        std::vector<std::string>& answers) {
    PipedProgram program(command(options));
    program.write(samples[0] + "\n");
    program.read_line();
    for (std::size_t k = first; k < last; ++k) {
      program.write(samples[k] + "\n");
      answers.push_back(program.read_line().value());
    }
    if (interrupt)
      program.send_signal(SIGINT);
    else
      program.close_input();
    EXPECT_EQ(program.wait(), 0) << program.errors();
  };
  const std::string checkpoint = file("state.json").string();
  feed({}, 1, 40, false, whole);
  feed({"--track.checkpoint", checkpoint}, 1, 20, true, parts);
  feed({"--track.resume", checkpoint, "--track.checkpoint", checkpoint}, 20, 30, false, parts);
  feed({"--track.resume", checkpoint}, 30, 40, false, parts);
  EXPECT_EQ(parts, whole);

  const ProgramResult other =
      modebank({"track", archive(), "--track.resume", checkpoint, "--track.filter", "baseline"});
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err, HasSubstr("is a checkpoint of another bank or of other filter settings"));
  write("half.json", "{\"format\": \"modebank checkpoint 1\"");
  EXPECT_EQ(modebank({"track", archive(), "--track.resume", file("half.json").string()}).status, 1);
  EXPECT_EQ(modebank({"track", archive(), "--track.resume", file("none.json").string()}).status, 2);
  EXPECT_EQ(modebank({"track", archive(), "--track.checkpoint", "/nowhere/state.json"}).status, 2);
}

TEST_F(TrackCheckpoint, KeepsCheckpointsOnTheWay) {
  const std::string checkpoint = file("state.json").string();
  PipedProgram program(command({"--track.checkpoint", checkpoint, "--track.checkpoint_interval", "5"}));
  const std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 0; k <= 6; ++k) {
    program.write(samples[k] + "\n");
    program.read_line();
  }
  EXPECT_TRUE(std::filesystem::exists(checkpoint));
}

}  // namespace
}  // namespace modebank::test
