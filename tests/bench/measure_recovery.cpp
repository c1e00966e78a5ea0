// Measures how often the right number of modes is found for simulated systems (docs/results/simulated.md). Argument:
// number of seeds (default 50).
#include <fmt/format.h>

#include <cstdlib>

#include "tests/app/chain/recovery_study.hpp"

namespace {

using modebank::test::RecoveredSize;
using modebank::test::RecoveryCase;

std::vector<RecoveryCase> cases() {
  std::vector<RecoveryCase> result;
  const auto add = [&](const char* name, modebank::Index hold, double dwell, modebank::Index step) -> RecoveryCase& {
    RecoveryCase recovery;
    recovery.name = name;
    recovery.hold_samples = hold;
    recovery.dwell_windows = dwell;
    recovery.step = step;
    result.push_back(recovery);
    return result.back();
  };
  const auto remedies = [&](const char* name, modebank::Index hold, double dwell) {
    add(name, hold, dwell, 5);
    add(name, hold, dwell, 5).noise_component = true;
  };
  add("one mode a run, step 1", 1, 0.0, 1);
  add("one mode a run, step L", 1, 0.0, 25);
  add("one mode a run, step 1", 1, 0.0, 1).noise_component = true;
  add("one mode a run, step L", 1, 0.0, 25).noise_component = true;
  remedies("held inputs, one mode a run", 5, 0.0);
  remedies("dwell 20 L", 1, 20.0);
  add("dwell 20 L, step L", 1, 20.0, 25);
  remedies("held inputs, dwell 20 L", 5, 20.0);
  remedies("dwell 4 L", 1, 4.0);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 50;
  fmt::print("| case | windows' step | noise component | right K | fewer | more | naive BIC right |\n");
  fmt::print("|---|---|---|---|---|---|---|\n");
  for (const RecoveryCase& recovery : cases()) {
    const std::vector<RecoveredSize> sizes = recover_sizes(recovery, seeds);
    int fewer = 0, more = 0;
    for (const RecoveredSize& size : sizes) (size.chosen < size.truth ? fewer : more) += size.chosen != size.truth;
    fmt::print("| {} | {} | {} | {} of {} | {} | {} | {} |\n", recovery.name, recovery.step,
               recovery.noise_component ? "yes" : "no", right(sizes, &RecoveredSize::chosen), seeds, fewer, more,
               right(sizes, &RecoveredSize::naive));
    std::fflush(stdout);
  }
}
