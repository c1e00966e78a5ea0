#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

/// Files that the reference implementation in TypeScript wrote (tests/golden/generate/mcap_core.mjs). Expected values
/// are the numbers in that script.
class McapCore : public ::testing::TestWithParam<const char*> {};

TEST_P(McapCore, IsReadWhole) {
  const RosLog log(golden_dir() / ("mcap_core_" + std::string(GetParam()) + ".mcap"), KnownDefinitions());
  EXPECT_TRUE(log.notes().empty());
  ASSERT_EQ(log.topics().size(), 1u);
  EXPECT_EQ(log.topics().front().messages, 40u);
  EXPECT_EQ(log.topics().front().type, "golden/msg/Sample");
  const WholeTopic topic = read_topic(log, "/golden");
  ASSERT_EQ(topic.rows.message.size(), 40u);
  for (std::size_t k = 0; k < 40; ++k) {
    const auto number = static_cast<double>(k);
    const std::int64_t step_ns = 25'000'000 * static_cast<std::int64_t>(k);
    EXPECT_EQ(topic.column("stamp").exact[k], 1'700'000'000'000'000'000 + step_ns);
    EXPECT_EQ(topic.column("receive_time").exact[k], 1'700'000'001'000'000'000 + step_ns);
    EXPECT_EQ(topic.column("x").numbers[k], number / 4);
    EXPECT_EQ(topic.column("n").numbers[k], -number);
    EXPECT_EQ(topic.column("s").text[k], "m" + std::to_string(k));
    EXPECT_EQ(topic.column("pair[0]").numbers[k], number);
    EXPECT_EQ(topic.column("pair[1]").numbers[k], number + 0.5);
  }
}

INSTANTIATE_TEST_SUITE_P(MessageFormat, McapCore, ::testing::Values("none", "lz4", "zstd", "unchunked", "bare"));

}  // namespace modebank::test
