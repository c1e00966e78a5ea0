// Linked into every test program. If the program called vector kernels, its last line of output names their instruction
// set.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <cstdio>

namespace {

/// The target that Highway's dispatch selects: the best target that is compiled and that the machine supports. 0 if no
/// kernel was called. This file is compiled with the same definitions as the kernels, so HWY_TARGETS has the same
/// value.
std::int64_t target_that_ran() {
  constexpr std::int64_t compiled = HWY_TARGETS;
  if constexpr ((compiled & (compiled - 1)) == 0) return compiled;  // a single target needs no dispatch
  if (!hwy::GetChosenTarget().IsInitialized()) return 0;
  const std::int64_t usable = hwy::SupportedTargets() & compiled;
  return usable & -usable;  // the lowest bit is the best target
}

class NamesInstructionSet : public ::testing::EmptyTestEventListener {
  void OnTestProgramEnd(const ::testing::UnitTest&) override {
    if (const std::int64_t target = target_that_ran()) std::printf("vector kernels: %s\n", hwy::TargetName(target));
  }
};

[[maybe_unused]] const bool listens = [] {
  ::testing::UnitTest::GetInstance()->listeners().Append(new NamesInstructionSet);
  return true;
}();

}  // namespace
