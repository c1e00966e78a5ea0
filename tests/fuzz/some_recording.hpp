#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/random.hpp"

namespace modebank::fuzz {

/// A message type with one message of it, as ROS 1 and as ROS 2 write both.
struct SomeType {
  std::string name, ros1, ros2, ros1_message, ros2_message;
};
const std::vector<SomeType>& some_types();

/// Words of definitions.
std::vector<std::string> definition_tokens();

/// Whole recordings, but that here and there a definition, a message, a size, a time or a number is another one.
std::string some_bag(Random& random);
std::string some_mcap(Random& random);
std::string some_db3(Random& random);

}  // namespace modebank::fuzz
