#include "io/archive/groups/sizes.hpp"

namespace modebank {

namespace {

std::string text_of(const hdf5::Shape& shape) {
  std::string text;
  for (const hsize_t extent : shape) text += (text.empty() ? "" : ", ") + std::to_string(extent);
  return "shape (" + text + ")";
}

std::string joined_letters(const Letters& letters) {
  std::string text;
  for (const std::string& letter : letters) text += (text.empty() ? "" : ", ") + letter;
  return text;
}

}  // namespace

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
    return text_of(shape) + ", must have the dimensions (" + joined_letters(letters) + ")";
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const auto [known, is_new] = extents_.try_emplace(letters[i], shape[i]);
    if (!is_new && known->second != shape[i])
      return text_of(shape) + ", but " + letters[i] + " is " + std::to_string(known->second);
  }
  return {};
}

}  // namespace modebank
