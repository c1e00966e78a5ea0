#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/recording/payload.hpp"

namespace modebank {

/// One column of a message: `field.sub[0]`, or `field{name}` for the element of an array whose entry in the array
/// `name` beside it is that name.
struct MessageColumn {
  enum class Form { number, text, time };
  std::string path;
  Form form = Form::number;
};

/// The columns that a message has: every value but those of long sequences (the first 64 elements are listed) and of
/// blobs (more than 64 bytes in a row). Throws PayloadError when the message has not the form of the schema or is not
/// all consumed.
std::vector<MessageColumn> columns_of(const Schema& schema, std::string_view payload, unsigned wide_bytes);

/// Adds the columns that are new, behind what has the same array before them where there is such.
void merge_columns(std::vector<MessageColumn>& columns, const std::vector<MessageColumn>& more);

/// More are not listed.
inline constexpr std::uint64_t most_elements = 64;
inline constexpr std::size_t most_columns = 4096;

}  // namespace modebank
