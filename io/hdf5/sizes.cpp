#include "io/archive_sizes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace modebank {

std::optional<hsize_t> Sizes::find(const std::string& letter) const {
  const auto found = extents_.find(letter);
  return found == extents_.end() ? std::nullopt : std::optional<hsize_t>(found->second);
}

Sizes Sizes::only(const Letters& letters) const {
  Sizes result;
  for (const std::string& letter : letters)
    if (const auto extent = find(letter)) result.set(letter, *extent);
  return result;
}

std::string Sizes::agree(const Letters& letters, const hdf5::Shape& shape) {
  if (letters.size() != shape.size())
    return fmt::format("shape ({}), must have the dimensions ({})", fmt::join(shape, ", "), fmt::join(letters, ", "));
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const auto [known, is_new] = extents_.try_emplace(letters[i], shape[i]);
    if (!is_new && known->second != shape[i])
      return fmt::format("shape ({}), but {} is {}", fmt::join(shape, ", "), letters[i], known->second);
  }
  return {};
}

}  // namespace modebank
