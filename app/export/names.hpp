#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Names come from the user's files, and may hold anything; text that programs read gets them through here alone.
namespace modebank::app {

enum class Language { c, python };

/// One identifier [A-Za-z_][A-Za-z0-9_]* per name, in order: all different, and none a word of the language (for C
/// those of C++, too). What else a name holds becomes '_'.
std::vector<std::string> identifiers(const std::vector<std::string>& names, Language language);

/// For a comment of one line: no line break, no control character, nothing that ends or begins a comment, no backslash
/// (which would join lines), and UTF-8.
std::string comment_text(std::string_view text);

/// A double-quoted scalar of YAML, which is one of JSON, too, and a string of Python: ASCII.
std::string quoted_scalar(std::string_view text);

/// A file's name without folder and extension: letters, digits, '_' and '-'.
std::string file_stem(std::string_view text);

}  // namespace modebank::app
