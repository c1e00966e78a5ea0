#pragma once

#include <string_view>

namespace modebank {

/// Writes text to standard error. Returns false if text had to be dropped. A full or closed log thus does not stop the
/// program.
bool say(std::string_view text);

/// Writes text without waiting. Text is dropped if the reader has no room for it.
bool say_now(std::string_view text);

/// Opens closed standard streams in such a way that using them still fails. Otherwise a file that is opened later would
/// get the number of such a stream, and messages would be written into this file. Call this function before any file is
/// opened.
void occupy_standard_streams();

}  // namespace modebank
