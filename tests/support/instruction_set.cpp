// Preloaded before a test program (LD_PRELOAD). The vector kernels of the program then use the instruction set that
// MODEBANK_TEST_INSTRUCTION_SET names (AVX3, AVX2, SCALAR) instead of the machine's best. Ends the program with
// `skipped` if the machine lacks this instruction set. Ends it with `unused` if no kernel was called, so that a test
// cannot pass with another instruction set.
#include <hwy/targets.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

constexpr int skipped = 77, unused = 78;

std::int64_t target_of(const char* name) {
  for (int bit = 0; bit < 63; ++bit)
    if (std::strcmp(hwy::TargetName(std::int64_t{1} << bit), name) == 0) return std::int64_t{1} << bit;
  return 0;
}

class InstructionSet {
 public:
  InstructionSet() {
    if (!name_) return;
    const std::int64_t target = target_of(name_);
    if (target == 0) {
      std::fprintf(stderr, "no instruction set is called %s\n", name_);
      _exit(unused);
    }
    if ((hwy::SupportedTargets() & target) == 0) {
      std::fprintf(stderr, "this machine has no instruction set %s\n", name_);
      _exit(skipped);
    }
    hwy::SetSupportedTargetsForTest(target);
  }
  ~InstructionSet() {
    if (!name_ || hwy::GetChosenTarget().IsInitialized()) return;
    std::fprintf(stderr, "no kernel was called in the instruction set %s\n", name_);
    _exit(unused);
  }
  InstructionSet(const InstructionSet&) = delete;
  InstructionSet& operator=(const InstructionSet&) = delete;

 private:
  const char* name_ = std::getenv("MODEBANK_TEST_INSTRUCTION_SET");
};

const InstructionSet chosen;

}  // namespace
