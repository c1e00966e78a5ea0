#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Names from users' files may contain any character. These functions make names safe for files that programs read.
namespace modebank::app {

enum class Language { c, python };

/// One unique identifier [A-Za-z_][A-Za-z0-9_]* per name, in order. None is a keyword of the language (for C also of
/// C++). Other characters become '_'.
std::vector<std::string> identifiers(const std::vector<std::string>& names, Language language);

/// Text for a comment of one line, in UTF-8. Contains no line breaks, control characters, comment marks or backslashes
/// (which would join lines).
std::string comment_text(std::string_view text);

/// A double-quoted ASCII scalar that is valid in YAML, JSON and Python.
std::string quoted_scalar(std::string_view text);

/// A file name without folder and extension: letters, digits, '_' and '-'.
std::string file_stem(std::string_view text);

}  // namespace modebank::app
