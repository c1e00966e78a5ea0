#pragma once

#include <string>
#include <vector>

#include "io/recording/ros_log.hpp"

namespace modebank {

/// Text columns of a topic that name the frame of a message, the child's before its parent's; of an array those of its
/// first element.
std::vector<std::string> frame_columns(const LogTopic& topic);

/// In words, between which frames a topic's messages alternate and the key that takes them apart; empty where they do
/// not: a recorder that starts anew in another frame goes back to none. `frames`: one value per message.
std::string alternation_text(const LogTopic& topic, const std::string& column, const std::vector<std::string>& frames);

}  // namespace modebank
