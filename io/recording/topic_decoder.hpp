#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/recording/connections.hpp"
#include "io/recording/known_definitions.hpp"
#include "io/recording/message_columns.hpp"

namespace modebank {

/// The definition for the messages of one connection. It is the first candidate that fits the first and the last
/// message without leftover bytes.
struct TopicDecoder {
  std::shared_ptr<const Schema> schema;  ///< null if there is none; `problem` then states the reason
  unsigned wide_bytes = 4;
  std::vector<MessageColumn> columns;  ///< columns of the connection's first and last message
  std::string problem;
};

/// `samples`: messages of the connection. May be empty.
TopicDecoder choose_decoder(const Connection& connection, const KnownDefinitions& known,
                            const std::vector<std::string>& samples);

}  // namespace modebank
