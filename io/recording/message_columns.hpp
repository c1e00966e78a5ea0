#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/recording/payload.hpp"

namespace modebank {

/// One column of a message: `field.sub[0]`, or `field{left}` for the array element whose entry in the neighbouring
/// array `name` is "left".
struct MessageColumn {
  enum class Form { number, text, time };
  std::string path;
  Form form = Form::number;
};

/// The columns of a message: all values except blobs (more than 64 bytes in a row) and elements of sequences after the
/// first 64. Throws PayloadError if the message does not fit the schema or bytes are left over.
std::vector<MessageColumn> columns_of(const Schema& schema, std::string_view payload, unsigned wide_bytes);

/// Adds new columns, each after a column of the same array if there is one.
void merge_columns(std::vector<MessageColumn>& columns, const std::vector<MessageColumn>& more);

/// Further elements are not listed.
inline constexpr std::uint64_t most_elements = 64;
inline constexpr std::size_t most_columns = 4096;

}  // namespace modebank
