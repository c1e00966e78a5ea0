#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/array.hpp"

namespace modebank {

/// Unit of every entry of one sample. An empty text is an unknown unit; an empty list means that the array has no
/// units.
using Unit = std::vector<std::string>;

/// Letters of the layout (M windows, K modes, n states, ...), one per dimension of an array.
using Letters = std::vector<std::string>;

/// The extents of the letters within one part of the archive. The first array with a letter binds the letter. All later
/// arrays must have the same extent.
class Sizes {
 public:
  void set(const std::string& letter, hsize_t extent) { extents_[letter] = extent; }
  std::optional<hsize_t> find(const std::string& letter) const;
  /// The extents of these letters, without letters that are not bound.
  Sizes only(const Letters& letters) const;
  /// Binds free letters. Returns a description if extents disagree, for example "shape (10, 3), but M is 12"; otherwise
  /// an empty text.
  std::string agree(const Letters& letters, const hdf5::Shape& shape);

 private:
  std::map<std::string, hsize_t> extents_;
};

}  // namespace modebank
