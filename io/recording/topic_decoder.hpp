#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/recording/connections.hpp"
#include "io/recording/known_definitions.hpp"
#include "io/recording/message_columns.hpp"

namespace modebank {

/// How one connection's messages are read: the first of the definitions at hand that consumes its first and its last
/// message whole.
struct TopicDecoder {
  std::shared_ptr<const Schema> schema;  ///< none: `problem` says why
  unsigned wide_bytes = 4;
  std::vector<MessageColumn> columns;  ///< of its first and its last message
  std::string problem;
};

/// `samples`: messages of the connection, if it has any.
TopicDecoder choose_decoder(const Connection& connection, const KnownDefinitions& known,
                            const std::vector<std::string>& samples);

}  // namespace modebank
