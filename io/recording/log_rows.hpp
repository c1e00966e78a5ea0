#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/recording/message_reader.hpp"
#include "io/recording/ros_log.hpp"

namespace modebank {

/// Collects the rows of one requested topic. The topic may have several connections.
class RowCollector {
 public:
  RowCollector(const LogTopic& topic, const LogRequest& request);

  /// Adds a reader for messages of a connection with this decoder. Returns the reader's number for `take`. Throws
  /// DataError if the definition is missing. Throws ConfigurationError if the definition lacks a requested column.
  std::size_t add_reader(const TopicDecoder& decoder);

  /// Adds a message. Throws DataError if the message does not fit its definition.
  void take(std::size_t reader, const RecordedMessage& message, const std::string& file);

  /// The rows in order of receive time.
  LogRows finish(std::vector<std::string>& notes);

 private:
  struct Reader {
    MessageReader messages;
    std::vector<std::size_t> slots;       ///< one for each requested column
    std::vector<std::size_t> named = {};  ///< those of columns such as velocity{left}
  };

  void append(LogColumn& column, const LogWant& want, const Value& value, const std::string& file);

  const LogTopic& topic_;
  const LogRequest& request_;
  std::vector<Reader> readers_;
  std::vector<Value> row_;
  std::uint64_t messages_ = 0;  ///< number of messages so far, also of those that are no rows
  std::vector<std::int64_t> receive_ns_;
  std::vector<std::size_t> rounded_;  ///< number of values that a double cannot represent exactly, for each requested
                                      ///< column
  LogRows rows_;
};

}  // namespace modebank
