#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/fuzz/target.hpp"

namespace modebank::fuzz {

/// How long and with what.
struct Effort {
  std::uint64_t seed = 1;
  std::uint64_t count = 0;  ///< of mutated inputs
  double seconds = 0.0;     ///< by the clock; 0: until `count`
  std::uint64_t first = 0;  ///< iteration to begin with
  unsigned most_findings = 20;
  std::filesystem::path findings = ".";  ///< folder for their inputs
};

struct Outcome {
  std::uint64_t inputs = 0, taken = 0, refused = 0;
  unsigned findings = 0;
  double processor_s = 0.0, slowest_s = 0.0;  ///< of the process under test; of one input
  double most_megabytes = 0.0;                ///< that the process grew
  std::string refusal;                        ///< what the last refused input was told
};

/// What one input may cost.
inline constexpr double most_processor_s = 20.0, most_megabytes = 800.0;

/// Runs the target's corpus, then inputs that it makes, in a process of its own that is started again after each
/// finding. A finding is printed with seed and iteration, its input saved.
Outcome fuzz(const Target& target, const Effort& effort);

/// One input, in the same way; true when there is nothing to find.
bool replay(const Target& target, const std::string& input, const std::string& name);

}  // namespace modebank::fuzz
