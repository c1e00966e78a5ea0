#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace modebank {

/// Names of an enumeration's values for users, in the order of the values (from 0). Each enumeration specialises this
/// template at its definition. Configuration, help text and archive all use this list.
template <class E>
struct EnumNames;

template <class E>
constexpr std::string_view name_of(E value) {
  return EnumNames<E>::values.at(static_cast<std::size_t>(value));
}

template <class E>
constexpr std::optional<E> parse_name(std::string_view word) {
  for (std::size_t i = 0; i < EnumNames<E>::values.size(); ++i)
    if (EnumNames<E>::values[i] == word) return static_cast<E>(i);
  return std::nullopt;
}

template <std::size_t N>
using Names = std::array<std::string_view, N>;

}  // namespace modebank
