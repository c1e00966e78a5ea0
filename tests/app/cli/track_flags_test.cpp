// Flags that mark unreliable lines in the output of `track`.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class TrackFlags : public Track {
 protected:
  /// Sends CSV lines after the header. Returns the answers as objects.
  std::vector<json> answers(const std::vector<std::string>& sent, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{"--json"};
    words.insert(words.end(), options.begin(), options.end());
    PipedProgram program(command(words));
    program.write("time,wz,left,right\n");
    std::vector<json> said;
    for (const std::string& line : sent) {
      program.write(line + "\n");
      said.push_back(json::parse(program.read_line().value()));
    }
    program.close_input();
    EXPECT_EQ(program.wait(), 0);
    return said;
  }
  /// Samples of the held-out run.
  std::vector<std::string> samples(std::size_t count) const {
    const std::vector<std::string> all = lines("run_01.csv");
    return {all.begin() + 1, all.begin() + 1 + static_cast<std::ptrdiff_t>(count)};
  }
  static std::vector<std::string> raised(const json& line) {
    std::vector<std::string> names;
    for (const char* name : {"warming_up", "input_beyond_training", "unlike_any_mode", "stamp_late"})
      if (line.at(name).get<bool>()) names.emplace_back(name);
    return names;
  }
  /// The largest value of the first input in the file of the training run.
  double largest_input() const {
    double largest = -1.0;
    const std::vector<std::string> all = lines("run_00.csv");
    for (std::size_t k = 1; k < all.size(); ++k) largest = std::max(largest, numbers(all[k])[2]);
    return largest;
  }
};

TEST_F(TrackFlags, TheStartAndTenPredictionsWarmUp) {
  const std::vector<json> said = answers(samples(14));
  for (std::size_t k = 0; k < said.size(); ++k) EXPECT_EQ(said[k].at("warming_up"), k < 11) << k;
}

TEST_F(TrackFlags, EachSampleHasItsOwn) {
  std::vector<std::string> sent = samples(12);
  const double limit = largest_input();
  sent.push_back(fmt::format("1.2,,{},0.1", limit));
  sent.push_back(fmt::format("1.3,,{},0.1", limit + 1e-9));
  sent.push_back("1.4,100,0.1,0.1");
  sent.push_back("1.5,,0.1,0.1");
  sent.push_back("1.64,,0.1,");     // 1.4 steps later; the input is missing, so the last value is repeated
  sent.push_back("1.79,,0.1,0.1");  // 1.5 steps
  sent.push_back("90,0.01,0.1,0.1");
  const std::vector<json> said = answers(sent);
  EXPECT_THAT(raised(said[11]), ElementsAre());
  EXPECT_THAT(raised(said[12]), ElementsAre());
  EXPECT_THAT(raised(said[13]), ElementsAre("input_beyond_training"));
  EXPECT_THAT(raised(said[14]), ElementsAre("unlike_any_mode"));
  EXPECT_EQ(said[14].at("alarm"), true);
  EXPECT_THAT(raised(said[15]), ElementsAre());
  EXPECT_THAT(raised(said[16]), ElementsAre());
  EXPECT_THAT(raised(said[17]), ElementsAre("stamp_late"));
  EXPECT_THAT(raised(said[18]), ElementsAre("warming_up", "stamp_late")) << "the filter starts anew";
}

TEST_F(TrackFlags, CsvHasThemBehindTheAlarm) {
  const ProgramResult result = modebank({"track", archive(), "--data.inputs", file("run_01.csv").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  std::istringstream text(result.out);
  std::string header, first;
  std::getline(text, header);
  std::getline(text, first);
  EXPECT_THAT(header, HasSubstr(",alarm,warming_up,input_beyond_training,unlike_any_mode,stamp_late,mode,"));
  const std::vector<double> v = numbers(first);
  EXPECT_THAT(std::vector<double>(v.begin() + 9, v.begin() + 14), ElementsAre(0, 1, 0, 0, 0));
}

/// Combined filters start with the filter that has the most lags.
TEST_F(TrackFlags, LagsAndTheFiltersTogetherWarmUpLonger) {
  ASSERT_EQ(run({"--window.model", "varx", "--window.state_lags", "4"}).status, 0);
  for (const std::string filter : {"bank", "combined"}) {
    const std::vector<json> said = answers(samples(20), {"--track.filter", filter});
    for (std::size_t k = 0; k < said.size(); ++k) EXPECT_EQ(said[k].at("warming_up"), k < 14) << filter << " " << k;
  }
}

TEST_F(TrackFlags, ACheckpointKeepsThem) {
  const std::vector<std::string> all = samples(16);
  const std::vector<json> whole = answers(all);
  const std::string state = file("state.json").string();
  const std::vector<json> head = answers({all.begin(), all.begin() + 5}, {"--track.checkpoint", state});
  const std::vector<json> tail = answers({all.begin() + 5, all.end()}, {"--track.resume", state});
  ASSERT_EQ(head.size() + tail.size(), whole.size());
  for (std::size_t k = 0; k < tail.size(); ++k) EXPECT_EQ(tail[k], whole[head.size() + k]) << k;
}

}  // namespace
}  // namespace modebank::test
