#pragma once

#include <string>
#include <vector>

#include "io/recording/ros_log.hpp"

namespace modebank {

/// Text columns of a topic that name the frame of a message, the child's before its parent's. For an array they are
/// those of its first element.
std::vector<std::string> frame_columns(const LogTopic& topic);

/// A sentence on the frames between which a topic's messages alternate, with the key that separates them. Empty if they
/// do not alternate: a recorder that restarts in another frame never returns to an earlier one. `frames`: one value per
/// message.
std::string alternation_text(const LogTopic& topic, const std::string& column, const std::vector<std::string>& frames);

}  // namespace modebank
