#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A definition of a message type that cannot be used.
struct DefinitionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class Kind : std::uint8_t {
  boolean,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  string,
  wstring,
  time,      ///< seconds and nanoseconds, 4 bytes each
  duration,  ///< the same, signed
  message
};

enum class Many : std::uint8_t { one, fixed, sequence };

struct MessageType;

struct Field {
  std::string name;
  Kind kind = Kind::message;
  const MessageType* type = nullptr;  ///< of Kind::message
  Many many = Many::one;
  std::uint64_t count = 1;  ///< of Many::fixed
};

struct MessageType {
  std::string name;  ///< package/Type
  std::vector<Field> fields;
  std::uint64_t least_bytes = 0;  ///< that any message of it takes (without alignment)
};

/// ROS 1 and ROS 2 write definitions alike, but mean other things by `byte`, `time` and an empty type.
enum class Dialect { ros1, ros2 };

/// A message type with all that it is made of.
class Schema {
 public:
  /// The text of the definition of package/Type, or nothing.
  using Lookup = std::function<std::optional<std::string_view>(const std::string& type)>;

  /// Throws DefinitionError for text that is no definition, a type that is not found, and types nested too deeply.
  Schema(const std::string& root, Dialect dialect, const Lookup& lookup);

  const MessageType& root() const { return *root_; }
  Dialect dialect() const { return dialect_; }
  bool has_wide_strings() const { return has_wide_strings_; }
  /// All that decides how a payload is read and what its fields are called: equal texts read alike.
  std::string text() const;

 private:
  const MessageType* resolve(const std::string& type, const Lookup& lookup, int depth);
  Field parse_field(std::string_view type, std::string_view name, const std::string& package, const Lookup& lookup,
                    int depth);

  Dialect dialect_;
  std::map<std::string, std::unique_ptr<MessageType>> types_;  ///< null: being resolved
  const MessageType* root_ = nullptr;
  bool has_wide_strings_ = false;
};

/// The parts of a text that holds several definitions, by package/Type: the first, of `root`, then those after lines
/// "MSG: package/Type" (and rows of '=', which may be left out).
std::map<std::string, std::string_view> split_definitions(const std::string& root, std::string_view text);

/// package/Type of package/msg/Type.
std::string short_type(std::string_view type);

/// Bytes of one value; 0 for strings and messages.
std::uint64_t bytes_of(Kind kind);

}  // namespace modebank
