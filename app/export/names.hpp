#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Names in users' files may contain any character. These functions make such names safe for files that programs read.
namespace modebank::app {

/// One unique identifier [A-Za-z_][A-Za-z0-9_]* per name, in order. Other characters become '_'. No identifier is a
/// keyword of C or C++.
std::vector<std::string> identifiers(const std::vector<std::string>& names);

/// Text for a one-line comment, in UTF-8. It contains no line breaks, control characters, comment marks or backslashes
/// (a backslash can join lines).
std::string comment_text(std::string_view text);

/// A file name without folder and extension. It contains only letters, digits, '_' and '-'.
std::string file_stem(std::string_view text);

}  // namespace modebank::app
