#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/recording/connections.hpp"
#include "io/recording/known_definitions.hpp"
#include "io/recording/topic_decoder.hpp"
#include "io/recording/used_messages.hpp"

namespace modebank {

/// One topic as a table. Each message is a row, in order of receive time.
struct LogTopic {
  std::string name;
  std::string type;
  std::vector<MessageColumn> columns;  ///< full names "/topic.field"; the last one is "/topic.receive_time"
  std::uint64_t messages = 0;
  std::string problem;  ///< reason why messages are unreadable and only the receive time is a column; otherwise empty
};

/// A requested column and the form in which its values are returned.
struct LogWant {
  enum class Form {
    number,  ///< numbers, and times in seconds; NaN if a message lacks the element
    text,    ///< texts, and numbers as text; empty if a message lacks the element
    exact  ///< times in nanoseconds, whole numbers exact, other numbers as doubles; the smallest integer where missing
  };
  std::string column;
  Form form = Form::number;
};

inline constexpr std::int64_t no_exact_value = std::numeric_limits<std::int64_t>::min();

struct LogRequest {
  std::size_t topic = 0;
  std::vector<LogWant> columns;
};

/// The values of a requested column in the requested form. The vectors of the other forms stay empty.
struct LogColumn {
  std::vector<double> numbers;
  std::vector<std::string> text;
  std::vector<std::int64_t> exact;
};

struct LogRows {
  std::vector<LogColumn> columns;      ///< columns in the order of the request
  std::vector<std::uint64_t> message;  ///< for each row, its number among the topic's messages, counted from 1
};

/// A recording of ROS (bag, MCAP or db3) in one file, or in several files in the order of writing. Messages are
/// flattened to columns.
class RosLog {
 public:
  /// Reads the index and a few messages. Throws ConfigurationError if a file cannot be read. Throws DataError if a file
  /// has another format or its beginning is damaged.
  RosLog(std::vector<std::filesystem::path> files, const KnownDefinitions& known);
  /// Opens the files that recording_files(path) returns.
  RosLog(const std::filesystem::path& path, const KnownDefinitions& known);
  ~RosLog();

  const std::vector<LogTopic>& topics() const { return topics_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// Remarks on the recording for the user.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Reads the requested columns in one pass. `notes` receives remarks on the values. `used`, unless null, receives all
  /// messages of these topics.
  /// Throws ConfigurationError for an unknown column. Throws DataError with topic, type and message if a message does
  /// not fit its definition.
  std::vector<LogRows> read(const std::vector<LogRequest>& requests, std::vector<std::string>& notes,
                            UsedMessages* used = nullptr) const;

 private:
  static constexpr std::size_t no_topic = ~std::size_t{0};
  struct Part {
    std::unique_ptr<Container> container;
    std::vector<TopicDecoder> decoders;  ///< per connection
    std::vector<std::size_t> topic;      ///< the topic of each connection; no_topic: the connection is not read
  };

  void open_part(const std::filesystem::path& path, const KnownDefinitions& known);
  void add_connection(Part& part, const Connection& connection, TopicDecoder decoder);

  std::vector<std::filesystem::path> files_;
  std::vector<Part> parts_;
  std::vector<LogTopic> topics_;
  std::vector<std::string> notes_;
};

/// Whether RosLog reads files that begin with these bytes. True for folders.
bool is_ros_log(const std::filesystem::path& path, std::string_view first_bytes);

}  // namespace modebank
