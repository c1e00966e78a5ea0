#pragma once

#include <filesystem>
#include <string_view>

#include "tests/fuzz/random.hpp"

namespace modebank::fuzz {

/// Chances that an input takes by itself: the same for the same bytes, so that a saved input does the same again.
Random chances_of(std::string_view input);

/// Opens a log as `run` does and reads all columns of all of its tables; which text and times, and whether values may
/// miss, is chance.
void read_all_tables(const std::filesystem::path& file, Random& chances);

/// The same through import: some of its columns as state, input, label, weight or run, joined and cleaned in some way.
void import_some(const std::filesystem::path& file, Random& chances);

}  // namespace modebank::fuzz
