#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/config/config.hpp"
#include "filter/learn/chain/inputs.hpp"

namespace modebank::app {

/// The alternatives in a range such as "auto | point | comma"; empty for a range without alternatives.
std::vector<std::string> choices_in(const std::string& text);

/// One configuration key. Its name, range, unit, help text and stage are only here. Its default is the value in a new
/// Config.
struct Option {
  std::string key;    ///< "section.name"; on the command line --section.name
  std::string range;  ///< allowed values, in words
  std::string unit;   ///< empty: none
  std::string help;
  std::function<void(Config&, const std::string&)> set;  ///< throws std::invalid_argument if the text is outside the
                                                         ///< range
  std::function<std::string(const Config&)> get;         ///< text from which `set` would set the same value
  std::optional<Stage> stage = {};                       ///< earliest stage whose numbers the key changes; empty if the
                                                         ///< key changes none
  bool basic = false;       ///< one of the few keys that most users set; help lists these first
  std::string when = {};    ///< when to change the key: a sentence without its full stop
  bool repeatable = false;  ///< the key may have several lines in a file; `get` separates their values by newlines
  std::vector<std::string> also = {};  ///< other words by which `help` finds the key

  /// The alternatives in `range`, such as "auto | point | comma"; empty if other values are allowed.
  std::vector<std::string> choices() const { return choices_in(range); }

  /// Sets `when`, `stage` and `basic`.
  Option touch(std::string sentence, std::optional<Stage> changed = {}, bool among_basic = false) && {
    when = std::move(sentence);
    stage = changed;
    basic = among_basic;
    return std::move(*this);
  }

  std::string section() const { return key.substr(0, key.find('.')); }
  std::string name() const { return key.substr(key.find('.') + 1); }
};

/// All options, section by section, in the order of the help text.
const std::vector<Option>& option_table();

/// The option with that key; null if there is none.
const Option* find_option(const std::string& key);
const Option* find_option(const std::vector<Option>& table, const std::string& key);

}  // namespace modebank::app
