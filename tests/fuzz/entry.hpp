#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace modebank::fuzz {

/// A reader of the program on arbitrary bytes. `read` returns, or throws one of the project's two exceptions. Anything
/// else (another exception, a signal, a sanitizer's report) is a finding. A static object per reader registers it by
/// its name, which is also its folder in tests/fuzz/corpus.
struct Entry {
  Entry(const char* name, void (*read)(std::string_view));
};

/// A file of this process, rewritten with the given content at each call.
std::filesystem::path scratch_file(std::string_view name, std::string_view content);

/// Throws std::logic_error, which is a finding.
void require(bool holds, const char* what);

}  // namespace modebank::fuzz
