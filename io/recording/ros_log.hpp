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

/// One topic as a table: a row per message, in order of receive time.
struct LogTopic {
  std::string name;
  std::string type;
  std::vector<MessageColumn> columns;  ///< whole names, "/topic.field"; "/topic.receive_time" last
  std::uint64_t messages = 0;
  std::string problem;  ///< why its messages cannot be read, or empty: then there is the receive time alone
};

/// A column, and in which form its values are wanted.
struct LogWant {
  enum class Form {
    number,  ///< times in seconds; NaN where a message has no such element
    text,    ///< numbers written out; empty where a message has no such element
    exact    ///< times in nanoseconds, whole numbers as they are, least where there is none; other numbers as numbers
  };
  std::string column;
  Form form = Form::number;
};

inline constexpr std::int64_t no_exact_value = std::numeric_limits<std::int64_t>::min();

struct LogRequest {
  std::size_t topic = 0;
  std::vector<LogWant> columns;
};

/// The values of one wanted column, in the form that was wanted; the others stay empty.
struct LogColumn {
  std::vector<double> numbers;
  std::vector<std::string> text;
  std::vector<std::int64_t> exact;
};

struct LogRows {
  std::vector<LogColumn> columns;      ///< as requested
  std::vector<std::uint64_t> message;  ///< per row, which of the topic it is in the recording, from 1
};

/// A recording of ROS: bag, MCAP or db3, one file or several that were written one after the other. Messages are
/// flattened to columns.
class RosLog {
 public:
  /// Looks into the index and a few messages. Throws ConfigurationError when a file cannot be read and DataError when
  /// it is damaged from the beginning or of another form.
  RosLog(std::vector<std::filesystem::path> files, const KnownDefinitions& known);
  /// recording_files of it.
  RosLog(const std::filesystem::path& path, const KnownDefinitions& known);
  ~RosLog();

  const std::vector<LogTopic>& topics() const { return topics_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// What a user should know of the recording.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Reads the requested columns in one pass; `notes` gets what a user should know of the values. Throws
  /// ConfigurationError for a column that a topic has not, DataError for a message that its definition does not fit
  /// (naming topic, type and message). `used`, unless null, takes in all messages of these topics.
  std::vector<LogRows> read(const std::vector<LogRequest>& requests, std::vector<std::string>& notes,
                            UsedMessages* used = nullptr) const;

 private:
  static constexpr std::size_t no_topic = ~std::size_t{0};
  struct Part {
    std::unique_ptr<Container> container;
    std::vector<TopicDecoder> decoders;  ///< per connection
    std::vector<std::size_t> topic;      ///< per connection; no_topic: it is not read
  };

  void open_part(const std::filesystem::path& path, const KnownDefinitions& known);
  void add_connection(Part& part, const Connection& connection, TopicDecoder decoder);

  std::vector<std::filesystem::path> files_;
  std::vector<Part> parts_;
  std::vector<LogTopic> topics_;
  std::vector<std::string> notes_;
};

/// Whether RosLog reads what begins with these bytes, or is a folder.
bool is_ros_log(const std::filesystem::path& path, std::string_view first_bytes);

}  // namespace modebank
