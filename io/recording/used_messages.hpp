#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "io/files/sha256.hpp"
#include "io/recording/connections.hpp"
#include "io/recording/topic_decoder.hpp"

namespace modebank {

/// What identifies the data that are read of a recording: the topics' names and types, the definitions by which their
/// messages are read, their receive times and payloads. Whatever else the recording holds, how its chunks are packed
/// and into how many files it is split changes nothing, so that nothing but what is used has to be read.
class UsedMessages {
 public:
  /// A connection of a topic of which messages follow.
  void add_definition(const std::string& topic, const std::string& type, const TopicDecoder& decoder);
  /// In the recording's order.
  void take(const std::string& topic, const RecordedMessage& message);

  /// SHA-256, lowercase hex, of everything so far: of each topic, by name, its name, type, definitions and messages'
  /// own SHA-256, each text and payload after its length.
  std::string hex() const;

 private:
  struct Topic {
    std::set<std::string> definitions;
    Sha256 messages;
  };
  std::map<std::string, Topic> topics_;
};

}  // namespace modebank
