#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace modebank::test {

/// What reading any bytes as a recording may do: give rows, or throw ConfigurationError or DataError. Everything else
/// (another exception, a crash, endless work or memory) is a fault of ours.
struct ReadOutcome {
  std::uint64_t rows = 0;  ///< of all topics
  bool refused = false;
};

/// Opens a file and reads every column of every topic that can be read.
ReadOutcome read_everything(const std::filesystem::path& path);

/// The same for bytes, which are put into `scratch`. A fuzz target's whole body.
ReadOutcome read_bytes_as_recording(std::string_view bytes, const std::filesystem::path& scratch);

/// The content with a few bits flipped, a stretch blanked or doubled, or its end cut off, by `seed` alone.
std::string mutated(std::string_view content, std::uint64_t seed);

}  // namespace modebank::test
