#pragma once

#include <filesystem>
#include <string>

namespace modebank {

/// Twelve random hexadecimal digits.
std::string random_word();

/// An unused path in the folder of `target`. Its name is .TARGET.modebank-RANDOM.tmp
std::filesystem::path temporary_path(const std::filesystem::path& target);

/// Whether a path is a leftover of a killed process. A leftover is a temporary path that was not written to for a day.
/// A living process writes more often. Machines that share a folder have clocks that differ by less than a day.
bool is_leftover(const std::filesystem::path& path);

/// Removes the leftovers in a folder. Files that cannot be read or removed stay, without a message.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace modebank
