#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/recording/payload.hpp"

namespace modebank {

/// Reads chosen columns (MessageColumn::path) from messages of one schema and skips the rest.
class MessageReader {
 public:
  explicit MessageReader(std::shared_ptr<const Schema> schema, unsigned wide_bytes);

  /// Requests a column; returns its index in the rows, equal for equal paths. Throws DefinitionError for an unknown
  /// column.
  std::size_t add(std::string_view path);

  /// Fills `row` with one value per requested column. A value is missing if its array is too short. Throws PayloadError
  /// as columns_of does.
  void read(std::string_view payload, std::vector<Value>& row) const;

 private:
  /// Requests on one field, or on one element of it.
  struct Want {
    std::size_t slot = none;                 ///< for the value itself
    std::map<std::size_t, Want> fields;      ///< for a message
    std::map<std::uint64_t, Want> elements;  ///< for an array
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
