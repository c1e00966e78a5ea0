#pragma once

#include <string>
#include <utility>
#include <vector>

#include "modebank/base/error.hpp"

namespace modebank::app {

/// The faults of a configuration or a command line. All are collected, so that users can correct them at once.
class Faults {
 public:
  /// Calls `read` and keeps the message of a ConfigurationError that it throws.
  template <class Read>
  void collect(Read&& read) {
    try {
      std::forward<Read>(read)();
    } catch (const ConfigurationError& error) {
      add(error.what());
    }
  }
  void add(std::string message) { messages_.push_back(std::move(message)); }

  /// Throws ConfigurationError. A single fault is the whole message; several faults are one line each.
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
