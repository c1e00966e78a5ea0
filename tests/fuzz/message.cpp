// Reads messages in the encodings of ROS 1 and of ROS 2 (CDR).
#include "io/recording/message_columns.hpp"
#include "io/recording/message_reader.hpp"
#include "io/recording/topic_decoder.hpp"
#include "tests/fuzz/entry.hpp"

namespace modebank::fuzz {

namespace {

/// The input contains the encoding, the definition up to a line "%%", and a message.
void read_message(std::string_view input) {
  Connection connection;
  connection.topic = "/t";
  connection.type = "p/T";
  connection.encoding = input.starts_with("ros1") ? Connection::Encoding::ros1 : Connection::Encoding::cdr;
  connection.definition_form = input.starts_with("ros1") ? "ros1msg" : "ros2msg";
  if (input.empty()) return;
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
  read(std::string_view(message).substr(0, message.size() / 2));  // later messages are shorter or longer
  read(message + message);
}

const Entry message("message", read_message);

}  // namespace

}  // namespace modebank::fuzz
