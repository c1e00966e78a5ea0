#pragma once

#include "io/recording/payload.hpp"

namespace modebank {

/// Number of elements of an array. For a sequence, the number is read from the message.
std::uint64_t length_of(const Field& field, PayloadReader& payload);

/// These functions skip elements of an array, or a whole field.
void skip_elements(const Field& field, std::uint64_t count, PayloadReader& payload);
void skip_field(const Field& field, PayloadReader& payload);

}  // namespace modebank
