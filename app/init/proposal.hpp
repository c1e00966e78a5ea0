#pragma once

#include <string>
#include <vector>

#include "app/init/file_sets.hpp"
#include "app/init/guess.hpp"

namespace modebank::app {

/// A key with its value and why; without a value a comment alone.
struct ProposedKey {
  std::string key, value, why;
};

/// What the [data] section is to say, key by key.
struct Proposal {
  std::vector<ProposedKey> keys;
  std::vector<std::string> doubts;  ///< what the user should look at before anything else
  std::vector<ChannelLeft> left;    ///< channels that move and were not taken

  const ProposedKey* find(const std::string& key) const;
  void add(std::string key, std::string value, std::string why = {});
  void doubt(const std::string& text);  ///< once
  void drop(const std::string& key);
  void set(const std::string& key, const std::string& value, const std::string& why);
};

/// `surveyed`: each set, by survey_set.
Proposal propose(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess,
                 const std::string& config_folder);

/// The configuration as text.
std::string configuration_text(const Proposal& proposal, const std::string& command);

}  // namespace modebank::app
