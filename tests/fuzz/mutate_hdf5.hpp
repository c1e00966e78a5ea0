#pragma once

#include <string>

#include "tests/fuzz/random.hpp"

namespace modebank::fuzz {

/// An HDF5 file with a few values, attributes, links, shapes or kinds of its objects changed by HDF5 itself; empty when
/// HDF5 cannot read what the changes made.
std::string edited_hdf5(Random& random, const std::string& content);

/// The same where the file begins with the hash of what follows its user block (archives, plans): edited, or changed
/// byte by byte, with the hash that it then has.
std::string mutated_archive(Random& random, const std::string& content);

}  // namespace modebank::fuzz
