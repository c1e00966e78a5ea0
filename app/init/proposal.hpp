#pragma once

#include <string>
#include <vector>

#include "app/init/file_sets.hpp"
#include "app/init/guess.hpp"

namespace modebank::app {

/// A key with its value and reason. A key without a value is written as a comment.
struct ProposedKey {
  std::string key, value, why;
};

/// The proposed [data] section, key by key.
struct Proposal {
  std::vector<ProposedKey> keys;
  std::vector<std::string> doubts;  ///< points that users should check first; stating a key that one names settles it
  std::vector<ChannelLeft> left;    ///< moving channels that are not used

  const ProposedKey* find(const std::string& key) const;
  void add(std::string key, std::string value, std::string why = {});
  void doubt(const std::string& text);  ///< adds a doubt, unless it was added before
  void drop(const std::string& key);
  void set(const std::string& key, const std::string& value, const std::string& why);
};

/// `surveyed`: for each set, the result of survey_set.
Proposal propose(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess,
                 const std::string& config_folder);

/// The first names of many, and the number of the others: "a, b, c, d, e, f and 3 more".
std::string first_of(std::vector<std::string> names);

/// The configuration as text.
std::string configuration_text(const Proposal& proposal, const std::string& command);

}  // namespace modebank::app
