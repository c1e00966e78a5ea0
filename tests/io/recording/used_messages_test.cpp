#include "io/recording/used_messages.hpp"

#include <gtest/gtest.h>

namespace modebank::test {

namespace {

TopicDecoder decoder_of(const std::string& definition) {
  TopicDecoder decoder;
  decoder.schema = std::make_shared<Schema>(
      "p/T", Dialect::ros2, [&](const std::string&) { return std::optional<std::string_view>(definition); });
  return decoder;
}

struct Sent {
  std::string topic;
  std::int64_t receive_ns;
  std::string payload;
};

std::string hash_of(const std::string& definition, const std::vector<Sent>& messages) {
  UsedMessages used;
  for (const char* topic : {"/a", "/b"}) used.add_definition(topic, "p/T", decoder_of(definition));
  for (const Sent& message : messages) used.take(message.topic, {0, message.receive_ns, message.payload});
  return used.hex();
}

const std::vector<Sent> messages{{"/a", 1, "xy"}, {"/b", 2, "z"}, {"/a", 3, ""}};

}  // namespace

TEST(UsedMessages, OtherFieldsMakeAnotherHash) {
  const std::string hash = hash_of("float64 v\nint32 n", messages);
  EXPECT_EQ(hash_of("# the same\nfloat64  v # [m/s]\n\nint32 n\nint32 MOST=3", messages), hash);
  EXPECT_NE(hash_of("float64 w\nint32 n", messages), hash);
  EXPECT_NE(hash_of("float64 v\nuint32 n", messages), hash);
  EXPECT_NE(hash_of("int32 n\nfloat64 v", messages), hash);
}

TEST(UsedMessages, EveryPartOfAMessageCounts) {
  const std::string definition = "float64 v", hash = hash_of(definition, messages);
  EXPECT_EQ(hash_of(definition, {{"/b", 2, "z"}, {"/a", 1, "xy"}, {"/a", 3, ""}}), hash);  // topics in another order
  EXPECT_NE(hash_of(definition, {{"/a", 3, ""}, {"/a", 1, "xy"}, {"/b", 2, "z"}}), hash);
  EXPECT_NE(hash_of(definition, {{"/a", 1, "x"}, {"/b", 2, "z"}, {"/a", 3, "y"}}), hash);
  EXPECT_NE(hash_of(definition, {{"/a", 1, "xy"}, {"/b", 5, "z"}, {"/a", 3, ""}}), hash);
  EXPECT_NE(hash_of(definition, {{"/b", 1, "xy"}, {"/a", 2, "z"}, {"/a", 3, ""}}), hash);
}

}  // namespace modebank::test
