#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config_file.hpp"
#include "app/init/proposal.hpp"

namespace modebank::app {

/// The configuration that `run LOG` writes. It contains the proposal of `init` for the data and keys of other sections,
/// each with its reason.
class LogConfiguration {
 public:
  LogConfiguration(Proposal proposal, std::string command)
      : proposal_(std::move(proposal)), command_(std::move(command)) {}

  const Proposal& proposal() const { return proposal_; }

  /// Sets a key of another section than [data], or changes its reason. An empty `value` writes only a comment.
  void set(const std::string& key, const std::string& value, const std::string& why);
  void doubt(const std::string& text) { proposal_.doubt(text); }
  /// Changes the reason of an existing key.
  void explain(const std::string& key, const std::string& why);

  std::string text() const;
  /// The configuration as the program would read it from `file`, with `archive` as the output.
  Config config(const std::filesystem::path& file, const std::filesystem::path& archive) const;

 private:
  /// A key of another section than [data]; without a value a comment.
  struct Key {
    std::string key, value, why;
  };

  Proposal proposal_;
  std::string command_;
  std::vector<Key> keys_;
};

}  // namespace modebank::app
