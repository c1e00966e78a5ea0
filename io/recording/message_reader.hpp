#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/recording/payload.hpp"

namespace modebank {

/// Reads chosen columns (MessageColumn::path) out of messages of one schema; the rest is skipped.
class MessageReader {
 public:
  explicit MessageReader(std::shared_ptr<const Schema> schema, unsigned wide_bytes);

  /// Where the column's values will be: the same for the same path. Throws DefinitionError when the schema has no such
  /// column.
  std::size_t add(std::string_view path);

  /// `row` gets one value per column that was added: missing where an array is shorter. Throws PayloadError as
  /// columns_of does.
  void read(std::string_view payload, std::vector<Value>& row) const;

 private:
  /// What is wanted of one field, or of one element of it.
  struct Want {
    std::size_t slot = none;                 ///< of the value itself
    std::map<std::size_t, Want> fields;      ///< of a message
    std::map<std::uint64_t, Want> elements;  ///< of an array
    std::map<std::string, Want, std::less<>> keyed;
    static constexpr std::size_t none = ~std::size_t{0};
  };

  std::size_t add_one(Want& want, const Field& field, std::string_view path, std::string_view whole);
  std::size_t add_field(Want& want, const MessageType& type, std::string_view path, std::string_view whole);
  static void read_message(const MessageType& type, const Want& want, PayloadReader& payload, std::vector<Value>& row);
  static void read_one(const Field& field, const Want& want, PayloadReader& payload, std::vector<Value>& row);
  static void read_array(const Field& field, const Want& want, const std::vector<std::string>& names,
                         PayloadReader& payload, std::vector<Value>& row);

  std::shared_ptr<const Schema> schema_;
  unsigned wide_bytes_;
  Want root_;
  std::size_t slots_ = 0;
};

}  // namespace modebank
