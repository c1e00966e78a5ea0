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

/// An unusable definition of a message type.
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
  const MessageType* type = nullptr;  ///< with Kind::message
  Many many = Many::one;
  std::uint64_t count = 1;  ///< with Many::fixed
};

struct MessageType {
  std::string name;  ///< package/Type
  std::vector<Field> fields;
  std::uint64_t least_bytes = 0;  ///< smallest size of such a message (without alignment)
};

/// ROS 1 and ROS 2 have the same syntax, but differ in the meaning of `byte`, `time` and an empty type.
enum class Dialect { ros1, ros2 };

/// A message type with all types that it uses.
class Schema {
 public:
  /// The text of the definition of package/Type; nullopt if unknown.
  using Lookup = std::function<std::optional<std::string_view>(const std::string& type)>;

  /// Throws DefinitionError for invalid text, a type without definition, and types nested too deeply.
  Schema(const std::string& root, Dialect dialect, const Lookup& lookup);

  const MessageType& root() const { return *root_; }
  Dialect dialect() const { return dialect_; }
  bool has_wide_strings() const { return has_wide_strings_; }
  /// A text that determines how payloads are read and fields are named. Schemas with equal texts are equivalent.
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

/// The definitions in one text, by package/Type: first that of `root`, then one after each line "MSG: package/Type"
/// (rows of '=' are optional).
std::map<std::string, std::string_view> split_definitions(const std::string& root, std::string_view text);

/// Converts package/msg/Type to package/Type.
std::string short_type(std::string_view type);

/// Size of one value; 0 for strings and messages.
std::uint64_t bytes_of(Kind kind);

}  // namespace modebank
