#pragma once

#include <string>
#include <vector>

#include "io/recording/ros_log.hpp"

namespace modebank {

/// Text columns of a topic that contain the frame of a message. The child's frame comes before its parent's frame. For
/// an array, these are the columns of the first element.
std::vector<std::string> frame_columns(const LogTopic& topic);

/// A sentence about the frames between which a topic's messages alternate, with the key that separates these frames.
/// `frames`: one value per message. Empty if no frame returns after another frame. (A recorder that restarts in another
/// frame does not return to the earlier frame.)
std::string alternation_text(const LogTopic& topic, const std::string& column, const std::vector<std::string>& frames);

}  // namespace modebank
