#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace modebank::fuzz {

/// A reader of the program that gets arbitrary bytes. `read` must return or throw one of the project's two exceptions.
/// Anything else (another exception, a signal, a sanitizer's report) is a bug. A static object registers each reader by
/// its name, which is also the name of its folder in tests/fuzz/corpus.
struct Entry {
  Entry(const char* name, void (*read)(std::string_view));
};

/// A file of this process. Each call replaces its content by the given content.
std::filesystem::path scratch_file(std::string_view name, std::string_view content);

/// Throws std::logic_error, which counts as a bug.
void require(bool holds, const char* what);

}  // namespace modebank::fuzz
