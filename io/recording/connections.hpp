#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// One stream of messages in a recording. A topic may have several connections.
struct Connection {
  std::string topic;
  std::string type;
  enum class Encoding { ros1, cdr, unknown };
  Encoding encoding = Encoding::unknown;
  std::string encoding_name;    ///< name of the encoding in the recording
  std::string definition;       ///< text of the definition; may be empty
  std::string definition_form;  ///< "ros1msg", "ros2msg", or any other word in the recording
  std::uint64_t messages = 0;
};

struct RecordedMessage {
  std::size_t connection = 0;
  std::int64_t receive_ns = 0;
  std::string_view payload;  ///< valid only during the call
};

using MessageSink = std::function<void(const RecordedMessage&)>;

/// A file of messages, in any format. If the file is damaged, it is read up to the damage.
class Container {
 public:
  virtual ~Container() = default;

  const std::vector<Connection>& connections() const { return connections_; }
  /// Problems that were found when the file was opened and that users should know, such as damage or a missing index.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Visits all messages of the wanted connections, in the order of the file. If the visit ends early, returns the
  /// reason; otherwise returns an empty text.
  virtual std::string visit(const std::vector<bool>& wanted, const MessageSink& sink) = 0;
  /// Visits at least the first and the last message of every connection, in the order of the file.
  virtual std::string sample(const MessageSink& sink) = 0;
  /// Closes the file until the next visit.
  virtual void close() = 0;

 protected:
  std::vector<Connection> connections_;
  std::vector<std::string> notes_;
};

/// A message or definition that is larger than this counts as damaged.
inline constexpr std::uint64_t most_message_bytes = std::uint64_t{256} << 20;
inline constexpr std::uint64_t most_definition_bytes = std::uint64_t{1} << 20;
/// A chunk that is larger than this, compressed or not, counts as damaged.
inline constexpr std::uint64_t most_chunk_bytes = std::uint64_t{256} << 20;
inline constexpr std::size_t most_connections = 65536;

}  // namespace modebank
