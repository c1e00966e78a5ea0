// Messages of ROS and what defines them.
#include "io/recording/message_columns.hpp"
#include "io/recording/message_reader.hpp"
#include "io/recording/topic_decoder.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/some_recording.hpp"
#include "tests/fuzz/target.hpp"

namespace modebank::fuzz {

namespace {

/// A definition of p/T as .msg files and recordings hold it, in both dialects, with a message of zeros.
void read_definition(std::string_view text) {
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    const auto parts = split_definitions("p/T", text);
    try {
      const Schema schema("p/T", dialect, [&](const std::string& type) -> std::optional<std::string_view> {
        const auto found = parts.find(type);
        return found == parts.end() ? std::nullopt : std::optional(found->second);
      });
      columns_of(schema, std::string(200, '\0'), 4);
    } catch (const DefinitionError&) {  // callers take both for words on why a topic cannot be read
    } catch (const PayloadError&) {
    }
  }
  scratch_file("T.msg", text);
  std::string problem;
  KnownDefinitions(scratch("")).candidates("p/T", problem);
}

/// First the encoding, then the definition to a line "%%", then a message.
void read_message(std::string_view input) {
  Connection connection;
  connection.topic = "/t";
  connection.type = "p/T";
  connection.encoding = input.starts_with("ros1") ? Connection::Encoding::ros1 : Connection::Encoding::cdr;
  connection.definition_form = input.starts_with("ros1") ? "ros1msg" : "ros2msg";
  const std::size_t begin = std::min(input.find('\n'), input.size() - 1) + 1;
  constexpr std::string_view between = "%%\n";
  const std::size_t end = std::min(input.find(between, begin), input.size());
  connection.definition = input.substr(begin, end - begin);
  const std::string message(input.substr(std::min(end + between.size(), input.size())));
  const TopicDecoder decoder = choose_decoder(connection, KnownDefinitions(), {message});
  if (!decoder.schema) return;
  MessageReader reader(decoder.schema, decoder.wide_bytes);
  for (const MessageColumn& column : decoder.columns) reader.add(column.path);
  std::vector<Value> row;
  const auto read = [&](std::string_view bytes) {
    try {
      reader.read(bytes, row);
    } catch (const PayloadError&) {
    }
  };
  read(message);
  read(std::string_view(message).substr(0, message.size() / 2));  // as a later message, shorter or longer
  read(message + message);
}

std::string make_message(Random& random) {
  const SomeType& type = random.pick(some_types());
  const bool ros1 = random.one_in(2);
  static const std::vector<std::string> tokens = definition_tokens();
  std::string definition = ros1 ? type.ros1 : type.ros2, message = ros1 ? type.ros1_message : type.ros2_message;
  if (random.one_in(3)) definition = mutated_text(random, {definition}, tokens);
  if (!random.one_in(4)) message = mutated_bytes(random, message);
  return (ros1 ? "ros1\n" : "cdr\n") + definition + "%%\n" + message;
}

}  // namespace

std::vector<Target> message_targets() {
  constexpr std::uint64_t million = 1'000'000;
  return {{"definition", million,
           [](Random& random) {
             static const auto texts = [] {
               std::vector<std::string> all = corpus("definition");
               for (const SomeType& type : some_types()) all.push_back(type.ros1), all.push_back(type.ros2);
               return all;
             }();
             static const std::vector<std::string> tokens = definition_tokens();
             return mutated_text(random, texts, tokens);
           },
           read_definition},
          {"message", million, make_message, read_message}};
}

}  // namespace modebank::fuzz
