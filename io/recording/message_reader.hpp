#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/recording/payload.hpp"

namespace modebank {

/// Reads chosen columns (MessageColumn::path) from messages of one schema. Skips all other values.
class MessageReader {
 public:
  explicit MessageReader(std::shared_ptr<const Schema> schema, unsigned wide_bytes);

  /// Requests a column and returns its index in the rows. Equal paths get the same index. Throws DefinitionError if the
  /// column is unknown.
  std::size_t add(std::string_view path);

  /// Fills `row` with one value for each requested column. A value is missing if its array is too short. Throws
  /// PayloadError in the same cases as columns_of.
  void read(std::string_view payload, std::vector<Value>& row) const;

 private:
  /// The requests for one field, or for one element of a field.
  struct Want {
    std::size_t slot = none;                 ///< requests for the value itself
    std::map<std::size_t, Want> fields;      ///< requests for the fields of a message
    std::map<std::uint64_t, Want> elements;  ///< requests for the elements of an array
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
