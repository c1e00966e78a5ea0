#include "io/recording/message_columns.hpp"
#include "io/recording/message_reader.hpp"
#include "io/recording/topic_decoder.hpp"
#include "tests/io/recording/recording_fixture.hpp"

namespace modebank::test {

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::shared_ptr<const Schema> schema_of(const std::string& text, Dialect dialect = Dialect::ros2) {
  static std::string kept;
  kept = text;
  const auto parts = split_definitions("p/T", kept);
  return std::make_shared<Schema>("p/T", dialect, [&](const std::string& type) -> std::optional<std::string_view> {
    const auto found = parts.find(type);
    return found == parts.end() ? std::nullopt : std::optional(found->second);
  });
}

std::vector<std::string> paths(const std::vector<MessageColumn>& columns) {
  std::vector<std::string> result;
  for (const MessageColumn& column : columns) result.push_back(column.path);
  return result;
}

Value value_of(const std::string& definition, const std::string& payload, const std::string& path,
               Dialect dialect = Dialect::ros2, unsigned wide_bytes = 4) {
  MessageReader reader(schema_of(definition, dialect), wide_bytes);
  const std::size_t slot = reader.add(path);
  std::vector<Value> row;
  reader.read(payload, row);
  return row[slot];
}

std::string bytes(std::initializer_list<int> values) {
  std::string result;
  for (const int value : values) result += static_cast<char>(value);
  return result;
}

const std::string little = bytes({0, 1, 0, 0}), big = bytes({0, 0, 0, 0});

}  // namespace

TEST(MessageFormat, CdrPutsEveryValueAtAMultipleOfItsSize) {
  const std::string definition = "uint8 a\nint16 b\nuint8 c\nint32 d\nuint8 e\nfloat64 f\n";
  // Positions after the header: a at 0, b at 2, c at 4, d at 8, e at 12, f at 16.
  const std::string payload =
      little + bytes({1, 9, 2, 0, 3, 9, 9, 9, 4, 0, 0, 0, 5, 9, 9, 9, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f});
  EXPECT_EQ(value_of(definition, payload, "a").number, 1.0);
  EXPECT_EQ(value_of(definition, payload, "b").number, 2.0);
  EXPECT_EQ(value_of(definition, payload, "c").number, 3.0);
  EXPECT_EQ(value_of(definition, payload, "d").number, 4.0);
  EXPECT_EQ(value_of(definition, payload, "e").number, 5.0);
  EXPECT_EQ(value_of(definition, payload, "f").number, 1.5);
}

TEST(MessageFormat, CdrMayBeBigEndian) {
  EXPECT_EQ(value_of("int16 a\nuint32 b\n", big + bytes({0xff, 0xfe, 9, 9, 1, 2, 3, 4}), "a").number, -2.0);
  EXPECT_EQ(value_of("int16 a\nuint32 b\n", big + bytes({0xff, 0xfe, 9, 9, 1, 2, 3, 4}), "b").number, 0x01020304);
}

TEST(MessageFormat, Ros1PutsValuesSideBySide) {
  const std::string definition = "byte a\ntime t\nduration d\nstring s\nchar c\n";
  const std::string payload = bytes(
      {0xff, 0, 0, 0, 0xf0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2, 0, 0, 0, 'h', 'i', 200});
  EXPECT_EQ(value_of(definition, payload, "a", Dialect::ros1).number, -1.0);
  // The seconds of a time are unsigned; both parts of a duration are signed.
  EXPECT_EQ(value_of(definition, payload, "t", Dialect::ros1).exact, 0xf0000000LL * 1'000'000'000 + 1);
  EXPECT_EQ(value_of(definition, payload, "d", Dialect::ros1).exact, -1'000'000'001);
  EXPECT_EQ(value_of(definition, payload, "s", Dialect::ros1).text, "hi");
  EXPECT_EQ(value_of(definition, payload, "c", Dialect::ros1).number, 200.0);
}

TEST(MessageFormat, ConstantsDefaultsBoundsAndCommentsAreNoFields) {
  const auto schema = schema_of(
      "# a comment\nint32 LIMIT=5\nstring NAME = a # b\nstring<=10 s \"x # y\"\nint32[<=3] few [1, 2]\nint8 last 7 # "
      "seven\n");
  std::vector<std::string> names;
  for (const Field& field : schema->root().fields) names.push_back(field.name);
  EXPECT_THAT(names, ElementsAre("s", "few", "last"));
}

TEST(MessageFormat, NestedTypesTakeTheirPackageFromWhereTheyAreNamed) {
  const std::string definition =
      "Inner[2] inner\nq/Other other\n====\nMSG: p/Inner\nuint8 x\n====\nMSG: q/Other\nThird third\n====\nMSG: "
      "q/Third\nuint8 y\n";
  const auto columns = columns_of(*schema_of(definition), little + bytes({1, 2, 3}), 4);
  EXPECT_THAT(paths(columns), ElementsAre("inner[0].x", "inner[1].x", "other.third.y"));
  EXPECT_EQ(value_of(definition, little + bytes({1, 2, 3}), "inner[1].x").number, 2.0);
}

/// If two fields have the same name, a column is ambiguous.
TEST(MessageFormat, OneNameIsOfOneField) {
  EXPECT_THAT(message_of<DefinitionError>([] { schema_of("uint8 x\nfloat64[2] x\n"); }), HasSubstr("two fields \"x\""));
}

TEST(MessageFormat, AnEmptyTypeIsAByteInCdrAndNothingInRos1) {
  const std::string definition = "Empty e\nuint8 a\n====\nMSG: p/Empty\nint32 ONLY=1\n";
  EXPECT_EQ(value_of(definition, little + bytes({0, 7}), "a").number, 7.0);
  EXPECT_EQ(value_of(definition, bytes({7}), "a", Dialect::ros1).number, 7.0);
}

TEST(MessageFormat, TimesOfRos2AreSecondsAndExactNanoseconds) {
  const std::string definition = "builtin_interfaces/Time stamp\n";
  const Value value = value_of(definition, little + bytes({1, 0, 0, 0, 2, 0, 0, 0}), "stamp");
  EXPECT_EQ(value.exact, 1'000'000'002);
  EXPECT_EQ(value.number, 1.0 + 2e-9);
  EXPECT_EQ(columns_of(*schema_of(definition), little + bytes({1, 0, 0, 0, 2, 0, 0, 0}), 4).front().form,
            MessageColumn::Form::time);
}

TEST(MessageFormat, WideStringsAreFourOrTwoBytesPerCharacter) {
  const std::string four = little + bytes({2, 0, 0, 0, 'a', 0, 0, 0, 0xac, 0x20, 0, 0});
  const std::string two = little + bytes({3, 0, 0, 0, 'a', 0, 0xac, 0x20, 'b', 0});
  EXPECT_EQ(value_of("wstring s\n", four, "s").text, "a\u20ac");
  EXPECT_EQ(value_of("wstring s\n", two, "s", Dialect::ros2, 2).text, "a\u20acb");
  // The messages decide which of the definitions is right.
  Connection connection{"/t", "p/msg/T", Connection::Encoding::cdr, "cdr", "wstring s\n", "ros2msg", 1};
  EXPECT_EQ(choose_decoder(connection, KnownDefinitions(), {four}).wide_bytes, 4u);
  EXPECT_EQ(choose_decoder(connection, KnownDefinitions(), {two}).wide_bytes, 2u);
}

TEST(MessageFormat, ElementsAreFoundByTheNameBesideThem) {
  const std::string definition = "string[] name\nfloat32[] velocity\n";
  const std::string payload = little + bytes({2, 0,   0,   0, 5, 0, 0, 0, 'l', 'e', 'f', 't',  0,    9, 9, 9, 3,   0, 0,
                                              0, 'r', 'x', 0, 9, 2, 0, 0, 0,   0,   0,   0x80, 0x3f, 0, 0, 0, 0x40});
  const auto columns = columns_of(*schema_of(definition), payload, 4);
  EXPECT_THAT(paths(columns),
              ElementsAre("name[0]", "name[1]", "velocity[0]", "velocity[1]", "velocity{left}", "velocity{rx}"));
  EXPECT_EQ(value_of(definition, payload, "velocity{left}").number, 1.0);
  EXPECT_EQ(value_of(definition, payload, "velocity{rx}").number, 2.0);
  EXPECT_EQ(value_of(definition, payload, "velocity{none}").form, Value::Form::missing);
  EXPECT_EQ(value_of(definition, payload, "velocity[5]").form, Value::Form::missing);
}

TEST(MessageFormat, BlobsAreSkippedAndLongArraysListedInPart) {
  const std::string payload =
      little + bytes({65, 0, 0, 0}) + std::string(65, 'x') + bytes({9, 9, 9, 65, 0, 0, 0}) + std::string(65 * 4, '\0');
  const auto columns = columns_of(*schema_of("uint8[] data\nint32[] numbers\n"), payload, 4);
  ASSERT_EQ(columns.size(), 64u);
  EXPECT_EQ(columns.back().path, "numbers[63]");
}

TEST(MessageFormat, WhatDoesNotFitSaysWhere) {
  const auto error = [](const std::string& definition, const std::string& payload) {
    return message_of<PayloadError>([&] { columns_of(*schema_of(definition), payload, 4); });
  };
  EXPECT_THAT(error("int32 a\n", little + bytes({1, 2})), HasSubstr("it ends at byte 2, but needs 4 more"));
  EXPECT_THAT(error("int32 a\n", little + bytes({1, 0, 0, 0, 1, 0, 0, 0})), HasSubstr("it continues at byte 4"));
  EXPECT_THAT(error("int32[] a\n", little + bytes({255, 255, 255, 255})), HasSubstr("an array of 4294967295 elements"));
  EXPECT_THAT(message_of<PayloadError>([&] {
                value_of("string a\n", little + bytes({2, 0, 0, 0, 'a', 'b'}), "a");
              }),
              HasSubstr("has no end"));
  EXPECT_THAT(error("int32 a\n", bytes({0, 7, 0, 0, 1, 0, 0, 0})), HasSubstr("encapsulation 0x0007"));
  // The last word may be padded.
  EXPECT_NO_THROW(columns_of(*schema_of("uint8 a\n"), little + bytes({1, 0, 0, 0}), 4));
}

TEST(MessageFormat, DefinitionsThatCannotBeAreRefused) {
  const auto error = [](const std::string& definition) {
    return message_of<DefinitionError>([&] { schema_of(definition); });
  };
  EXPECT_THAT(error("Self x\n===\nMSG: p/Self\nSelf y\n"), HasSubstr("p/Self contains itself"));
  EXPECT_THAT(error("q/Missing x\n"), HasSubstr("no definition of q/Missing"));
  EXPECT_THAT(error("int32[99999999999999999999] x\n"), HasSubstr("is not the size of an array"));
  EXPECT_THAT(error("int32 9x-y\n"), HasSubstr("is not a field"));
  std::string deep = "A0 x\n";
  for (int i = 0; i < 40; ++i) deep += "===\nMSG: p/A" + std::to_string(i) + "\nA" + std::to_string(i + 1) + " x\n";
  EXPECT_THAT(error(deep), HasSubstr("nested more than 32 deep"));
}

/// Sixteen nested levels, each with 4,000 empty values, would take too long to visit.
TEST(MessageFormat, NothingIsWalkedThroughThatHasNoBytes) {
  std::string definition = "A0[4000] x\nuint8 a\n";
  for (int i = 0; i < 16; ++i)
    definition += "===\nMSG: p/A" + std::to_string(i) + "\nA" + std::to_string(i + 1) + "[4000] x\n";
  definition += "===\nMSG: p/A16\n";
  EXPECT_EQ(value_of(definition, bytes({7}), "a", Dialect::ros1).number, 7.0);
  EXPECT_THAT(message_of<PayloadError>([&] { value_of(definition, little + bytes({7}), "a"); }),
              HasSubstr("longer than the message"));
}

TEST(MessageFormat, ATypeBetweenReleasesIsReadByTheOneThatFits) {
  // sensor_msgs/Range with and without the variance, which ROS 2 Iron added.
  const std::string header = little + bytes({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0});
  const std::string range = header + bytes({1, 9, 9}) + std::string(16, '\0');
  Connection connection{"/r", "sensor_msgs/msg/Range", Connection::Encoding::cdr, "cdr", "", "", 1};
  const auto old = choose_decoder(connection, KnownDefinitions(), {range});
  EXPECT_EQ(old.problem, "");
  EXPECT_EQ(old.columns.back().path, "range");
  EXPECT_EQ(choose_decoder(connection, KnownDefinitions(), {range + std::string(4, '\0')}).columns.back().path,
            "variance");
}

}  // namespace modebank::test
