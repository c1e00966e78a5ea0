#pragma once

#include <filesystem>
#include <string_view>

#include "tests/fuzz/random.hpp"
#include "tests/fuzz/scratch.hpp"

namespace modebank::fuzz {

/// Chances that an input takes by itself: the same for the same bytes, so that a saved input does the same again.
Random chances_of(std::string_view input);

/// Opens a log as `run` does and reads all columns of all of its tables; which text and times, and whether values may
/// miss, is chance.
void read_all_tables(const std::filesystem::path& file, Random& chances);

/// The same through import: some of its columns as state, input, label, weight or run, joined and cleaned in some way.
void import_some(const std::filesystem::path& file, Random& chances);

/// The input as a file of that name, by one of the two.
template <const char* Name>
void read_as_file(std::string_view bytes) {
  Random chances = chances_of(bytes);
  const std::filesystem::path file = scratch_file(Name, bytes);
  if (chances.one_in(6))
    import_some(file, chances);
  else
    read_all_tables(file, chances);
}

}  // namespace modebank::fuzz
