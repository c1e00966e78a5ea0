#pragma once

#include <string>
#include <vector>

#include "app/init/file_sets.hpp"
#include "app/init/guess.hpp"

namespace modebank::app {

/// A key with its value and reason; without a value only a comment.
struct ProposedKey {
  std::string key, value, why;
};

/// The [data] section to propose, key by key.
struct Proposal {
  std::vector<ProposedKey> keys;
  std::vector<std::string> doubts;  ///< points that the user should check first
  std::vector<ChannelLeft> left;    ///< moving channels that were left out

  const ProposedKey* find(const std::string& key) const;
  void add(std::string key, std::string value, std::string why = {});
  void doubt(const std::string& text);  ///< adds a doubt once
  void drop(const std::string& key);
  void set(const std::string& key, const std::string& value, const std::string& why);
};

/// `surveyed`: the result of survey_set for each set.
Proposal propose(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess,
                 const std::string& config_folder);

/// The configuration as text.
std::string configuration_text(const Proposal& proposal, const std::string& command);

}  // namespace modebank::app
