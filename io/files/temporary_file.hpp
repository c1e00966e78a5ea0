#pragma once

#include <filesystem>
#include <string>

namespace modebank {

/// Twelve hexadecimal digits by chance.
std::string random_word();

/// A path in the folder of `target` that nothing has yet: .TARGET.modebank-RANDOM.tmp
std::filesystem::path temporary_path(const std::filesystem::path& target);

/// Whether a path is a temporary one that nobody has written to for a day: what a killed process left. A living one
/// writes more often, and clocks of machines that share a folder differ by less.
bool is_leftover(const std::filesystem::path& path);

/// Removes the leftovers in a folder. What cannot be read or removed stays, in silence: nothing depends on it.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace modebank
