#pragma once

#include "io/recording/payload.hpp"

namespace modebank {

/// Elements of an array; a sequence's number of them stands in the message.
std::uint64_t length_of(const Field& field, PayloadReader& payload);

/// Leaves out elements of an array, or a whole field.
void skip_elements(const Field& field, std::uint64_t count, PayloadReader& payload);
void skip_field(const Field& field, PayloadReader& payload);

}  // namespace modebank
