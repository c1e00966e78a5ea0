#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "io/files/sha256.hpp"
#include "io/recording/connections.hpp"
#include "io/recording/topic_decoder.hpp"

namespace modebank {

/// Identifies the data that are read from a recording: names and types of topics, definitions, receive times and
/// payloads of messages.
/// Other topics, the way chunks are compressed and the split into files do not change the result. Therefore only the
/// used messages must be read.
class UsedMessages {
 public:
  /// Adds the definition of a connection. The connection's messages follow.
  void add_definition(const std::string& topic, const std::string& type, const TopicDecoder& decoder);
  /// Adds a message. Messages must be added in the order of the recording.
  void take(const std::string& topic, const RecordedMessage& message);

  /// SHA-256 of the messages so far, in lowercase hex. It is computed from the topics in order of name. For each topic
  /// it covers name, type, definitions and the SHA-256 of the messages. The length of each text and payload precedes
  /// it.
  std::string hex() const;

 private:
  struct Topic {
    std::set<std::string> definitions;
    Sha256 messages;
  };
  std::map<std::string, Topic> topics_;
};

}  // namespace modebank
