#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/random.hpp"

namespace modebank::fuzz {

/// A text of the corpus with a few of its lines, fields, words and numbers changed, cut, doubled, exchanged or taken
/// from another; `tokens`: words of the format. At most `most_bytes` long.
std::string mutated_text(Random& random, const std::vector<std::string>& corpus,
                         const std::vector<std::string>& tokens);

/// Bytes with a few bits flipped, a stretch blanked, doubled or cut out, or a little-endian number of 1, 2, 4 or 8
/// bytes put somewhere or changed by little.
std::string mutated_bytes(Random& random, std::string bytes);

/// Text that is a number, of those that break programs most often.
std::string odd_number(Random& random);
/// The same as a whole number: small, or at a limit of some type.
std::uint64_t odd_whole(Random& random);
/// And as a value of double.
double odd_double(Random& random);

}  // namespace modebank::fuzz
