// Linked into every test program: its last line names the instruction set that its vector kernels used, if it called
// any.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <cstdio>

namespace {

/// The target that Highway's dispatch selects: the best one that is compiled and supported by the machine. This file is
/// compiled with the kernels' definitions, so HWY_TARGETS is theirs. 0: no kernel was called.
std::int64_t target_that_ran() {
  constexpr std::int64_t compiled = HWY_TARGETS;
  if constexpr ((compiled & (compiled - 1)) == 0) return compiled;  // no dispatch, as on ARM
  if (!hwy::GetChosenTarget().IsInitialized()) return 0;
  const std::int64_t usable = hwy::SupportedTargets() & compiled;
  return usable & -usable;  // Highway's lowest bit is its best target
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
