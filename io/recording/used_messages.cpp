#include "io/recording/used_messages.hpp"

#include <fmt/format.h>

namespace modebank {

namespace {

void add_number(Sha256& hash, std::uint64_t number) {
  std::array<char, sizeof number> bytes{};
  for (char& byte : bytes) {
    byte = static_cast<char>(number & 0xff);
    number >>= 8;
  }
  hash.update(bytes.data(), bytes.size());
}

void add_text(Sha256& hash, std::string_view text) {
  add_number(hash, text.size());
  hash.update(text);
}

}  // namespace

void UsedMessages::add_definition(const std::string& topic, const std::string& type, const TopicDecoder& decoder) {
  const std::string fields = decoder.schema ? decoder.schema->text() : std::string();
  topics_[topic].definitions.insert(fmt::format("{} {}\n{}", type, decoder.wide_bytes, fields));
}

void UsedMessages::take(const std::string& topic, const RecordedMessage& message) {
  Sha256& hash = topics_[topic].messages;
  add_number(hash, static_cast<std::uint64_t>(message.receive_ns));
  add_text(hash, message.payload);
}

std::string UsedMessages::hex() const {
  Sha256 hash;
  for (const auto& [name, topic] : topics_) {
    add_text(hash, name);
    add_number(hash, topic.definitions.size());
    for (const std::string& definition : topic.definitions) add_text(hash, definition);
    hash.update(topic.messages.hex());
  }
  return hash.hex();
}

}  // namespace modebank
