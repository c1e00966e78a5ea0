#pragma once

#include <string_view>

namespace modebank {

/// Writes text to standard error. Text that cannot be written is dropped, so that a full or closed log does not stop
/// the program. Returns false if text was dropped.
bool say(std::string_view text);

/// The same without waiting: text is dropped if the reader has no room for it.
bool say_now(std::string_view text);

/// Opens closed standard streams so that their use fails as before. Otherwise a file that is opened later would get the
/// number of such a stream, and messages would go into this file. Call it before any file is opened.
void occupy_standard_streams();

}  // namespace modebank
