#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/text/next_step.hpp"
#include "io/archive/archive.hpp"

/// The findings of `modebank demo` beside the truth of the system that it simulated.
namespace modebank::app {

/// A number of a mode, and of the ground that it is named after.
struct FoundNumber {
  std::string name, unit;
  double found = 0.0, error = 0.0;  ///< error: standard error; NaN where it is not known
  double truth = 0.0;
};

/// A mode of the bank, and the ground that most of its samples were driven on.
struct FoundGround {
  std::string ground;  ///< empty: none of them
  Index mode = 0;
  std::vector<FoundNumber> numbers;  ///< time constant, gains, noise
};

/// Most used mode first. Numbers are given where the ground is known.
struct DemoFindings {
  std::vector<FoundGround> modes;
  std::size_t grounds = 0;  ///< in truth
  double agreement = 0.0;   ///< share of the held-out samples whose most probable mode is one of their ground
};

/// Whether the archive and the system can be compared: a linear system with one state and named grounds, one bank
/// with the same channels, scored on labelled runs.
bool is_comparable(const Archive& archive, const Config& simulation);
DemoFindings compare_with_truth(const Archive& archive, const Config& simulation);

/// The same for people: 14 lines for two modes.
std::string demo_text(const Archive& archive, const DemoFindings& findings, const Settings& settings);
/// The same for programs: `agreement` and `modes`, see docs/reference/json.md.
nlohmann::json demo_json(const DemoFindings& findings);

}  // namespace modebank::app
