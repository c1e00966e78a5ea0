#pragma once

#include <string>
#include <utility>
#include <vector>

#include "modebank/base/error.hpp"

namespace modebank::app {

/// Collects the faults of a configuration or a command line, so that users can correct all of them at once.
class Faults {
 public:
  /// Calls `read`. If it throws a ConfigurationError, keeps the message.
  template <class Read>
  void collect(Read&& read) {
    try {
      std::forward<Read>(read)();
    } catch (const ConfigurationError& error) {
      add(error.what());
    }
  }
  void add(std::string message) { messages_.push_back(std::move(message)); }

  /// Throws ConfigurationError if there is a fault. The message of a single fault is unchanged. Several faults become
  /// one line each.
  void refuse() const {
    if (messages_.empty()) return;
    if (messages_.size() == 1) throw ConfigurationError(messages_.front());
    std::string text = std::to_string(messages_.size()) + " settings cannot be used:";
    for (const std::string& message : messages_) text += "\n  " + message;
    throw ConfigurationError(text);
  }

 private:
  std::vector<std::string> messages_;
};

}  // namespace modebank::app
