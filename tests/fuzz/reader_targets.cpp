#include "tests/fuzz/target.hpp"

namespace modebank::fuzz {

std::vector<Target> all_targets() { return joined({table_targets, message_targets, recording_targets, array_targets}); }

}  // namespace modebank::fuzz
