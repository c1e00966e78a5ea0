#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config_file.hpp"
#include "app/config/edit_file.hpp"
#include "app/init/proposal.hpp"

namespace modebank::app {

/// The configuration that `run LOG` makes: what init proposes of the data, and keys of other sections, each with its
/// reason.
class LogConfiguration {
 public:
  LogConfiguration(Proposal proposal, std::string command)
      : proposal_(std::move(proposal)), command_(std::move(command)) {}

  const Proposal& proposal() const { return proposal_; }

  /// Sets a key, or gives it another reason. `value` empty: a comment alone.
  void set(const std::string& key, const std::string& value, const std::string& why);
  /// The reason of a key that stands there.
  void explain(const std::string& key, const std::string& why);

  std::string text() const;
  /// As the program reads it from `file`, with that archive.
  Config config(const std::filesystem::path& file, const std::filesystem::path& archive) const;

 private:
  Proposal proposal_;
  std::string command_;
  std::vector<KeyEdit> edits_;  ///< of other sections
};

}  // namespace modebank::app
