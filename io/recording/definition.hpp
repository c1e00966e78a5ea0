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

/// Thrown if the definition of a message type is unusable.
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
  time,      ///< unsigned seconds and nanoseconds, 4 bytes each
  duration,  ///< signed seconds and nanoseconds, 4 bytes each
  message
};

enum class Many : std::uint8_t { one, fixed, sequence };

struct MessageType;

struct Field {
  std::string name;
  Kind kind = Kind::message;
  const MessageType* type = nullptr;  ///< with Kind::message
  Many many = Many::one;
  std::uint64_t count = 1;  ///< with Many::fixed
};

struct MessageType {
  std::string name;  ///< package/Type
  std::vector<Field> fields;
  std::uint64_t least_bytes = 0;  ///< smallest size of a message of this type, without alignment
};

/// The dialect of definitions. ROS 1 and ROS 2 have the same syntax, but `byte`, `time` and an empty type have
/// different meanings.
enum class Dialect { ros1, ros2 };

/// A message type, together with all types that it uses.
class Schema {
 public:
  /// Returns the text of the definition of package/Type. Nullopt if the type is unknown.
  using Lookup = std::function<std::optional<std::string_view>(const std::string& type)>;

  /// Throws DefinitionError for invalid text, for a type without a definition, and for types that are nested too
  /// deeply.
  Schema(const std::string& root, Dialect dialect, const Lookup& lookup);

  const MessageType& root() const { return *root_; }
  Dialect dialect() const { return dialect_; }
  bool has_wide_strings() const { return has_wide_strings_; }
  /// A text that contains all that determines how payloads are read and fields are named. If the texts of two schemas
  /// are equal, the schemas are equivalent.
  std::string text() const;

 private:
  const MessageType* resolve(const std::string& type, const Lookup& lookup, int depth);
  Field parse_field(std::string_view type, std::string_view name, const std::string& package, const Lookup& lookup,
                    int depth);

  Dialect dialect_;
  std::map<std::string, std::unique_ptr<MessageType>> types_;  ///< null while the type is being resolved
  const MessageType* root_ = nullptr;
  bool has_wide_strings_ = false;
};

/// The definitions in one text, by package/Type. The first definition is that of `root`. Each further definition
/// follows a line "MSG: package/Type". Rows of '=' are optional.
std::map<std::string, std::string_view> split_definitions(const std::string& root, std::string_view text);

/// Converts package/msg/Type to package/Type.
std::string short_type(std::string_view type);

/// Size of one value. 0 for strings and messages.
std::uint64_t bytes_of(Kind kind);

}  // namespace modebank
