#pragma once

#include <string>
#include <vector>

#include "io/recording/ros_log.hpp"

namespace modebank {

/// Text columns of a topic that name the frame of a message, the child's frame before its parent's. For an array, the
/// columns of its first element.
std::vector<std::string> frame_columns(const LogTopic& topic);

/// A sentence on the frames between which a topic's messages alternate, with the key that separates these frames. Empty
/// if messages do not alternate: after a restart in another frame, a recorder never returns to an earlier frame.
/// `frames`: one value per message.
std::string alternation_text(const LogTopic& topic, const std::string& column, const std::vector<std::string>& frames);

}  // namespace modebank
