#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/recording/payload.hpp"

namespace modebank {

/// One column of a message. Its path is `field.sub[0]`, or `field{left}` for the array element whose entry in the
/// neighbouring array `name` is "left".
struct MessageColumn {
  enum class Form { number, text, time };
  std::string path;
  Form form = Form::number;
};

/// The columns of a message. They contain all values except blobs (more than 64 bytes in a row) and, in a sequence, the
/// elements after the first 64. Throws PayloadError if the message does not fit the schema or is longer than the schema
/// allows.
std::vector<MessageColumn> columns_of(const Schema& schema, std::string_view payload, unsigned wide_bytes);

/// Adds new columns. Each is placed after the other columns of its array, if there are any.
void merge_columns(std::vector<MessageColumn>& columns, const std::vector<MessageColumn>& more);

/// Elements of a sequence beyond this number are not listed.
inline constexpr std::uint64_t most_elements = 64;
inline constexpr std::size_t most_columns = 4096;

}  // namespace modebank
