#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/random.hpp"

namespace modebank::fuzz {

/// A reader of the program under any bytes. `run` may return, or throw ConfigurationError or DataError; whatever else
/// happens (another exception, a signal, endless work or memory) is a finding.
struct Target {
  std::string name;
  std::uint64_t inputs = 0;  ///< of one whole campaign
  std::function<std::string(Random&)> make;
  std::function<void(std::string_view)> run;
};

/// No input is longer, but for archives, of which the smallest whole one is larger.
inline constexpr std::size_t most_bytes = 20'000;

/// The targets of each kind of input. A target makes what it needs when it is first used.
std::vector<Target> configuration_targets();
std::vector<Target> table_targets();
std::vector<Target> message_targets();
std::vector<Target> recording_targets();
std::vector<Target> array_targets();
std::vector<Target> filter_targets();
std::vector<Target> joined(std::initializer_list<std::vector<Target> (*)()> parts);

/// Every target of this program, in the order in which `all` runs them; each program defines its own.
std::vector<Target> all_targets();

/// The files of tests/fuzz/corpus/NAME in order of their names: seeds of mutations, and inputs that once were findings.
std::vector<std::string> corpus(const std::string& name);

}  // namespace modebank::fuzz
