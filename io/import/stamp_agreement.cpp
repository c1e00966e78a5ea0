#include "io/import/stamp_agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "io/table/stamp_pattern.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Ground = StampForm::Ground;
using Pool = std::vector<const FileStamps*>;

std::string shown(const FileStamps& of) {
  return fmt::format("{}:{}: column {}: \"{}\"", of.file, of.form.line, of.column, of.form.value);
}

std::string read_by(const std::string& pattern, const std::string& value) {
  const StampPattern by(pattern);
  const Stamp stamp = by.read(value).value_or(Stamp());
  const std::string text = iso_text(stamp.whole * 1'000'000'000 + stamp.billionths);
  return fmt::format("{} by {}", by.has_date() ? text : text.substr(text.find('T') + 1), pattern);
}

/// The finest time unit that the spacing in any file indicates. It then holds for all files of a logger, because all
/// files must be sampled fast enough for a robot.
TimeUnit agreed_unit(const Pool& pool) {
  TimeUnit finest = pool.front()->form.unit;
  for (const FileStamps* of : pool) {
    const bool same = of->form.unit == pool.front()->form.unit;
    const auto weak = [](const FileStamps* f) { return f->form.ground != Ground::spacing; };
    if (!same && (weak(of) || weak(pool.front())))
      throw DataError(fmt::format(
          "the times in {} look like {} and those in {} like {}; state the unit of all files as data.time_unit = UNIT",
          shown(*pool.front()), in_words(pool.front()->form.unit), shown(*of), in_words(of->form.unit)));
    if (ns_per(of->form.unit) < ns_per(finest)) finest = of->form.unit;
  }
  return finest;
}

/// The patterns that fit all files. If several patterns give the same times in all files, only one is kept.
std::vector<std::string> common_patterns(const Pool& pool) {
  StampForm common = pool.front()->form;
  for (const FileStamps* of : pool)
    if (of != pool.front() && !join_patterns(common, of->form))
      throw DataError(
          fmt::format("{} is a time by {}, but {} by {}; state one format for all files as data.time_format = PATTERN",
                      shown(*pool.front()), common.patterns.front(), shown(*of), of->form.patterns.front()));
  return common.patterns;
}

/// Throws DataError. The message names the first file for which the patterns give different times.
[[noreturn]] void refuse_ambiguous(const Pool& pool, const std::vector<std::string>& patterns) {
  const auto differing =
      std::find_if(pool.begin(), pool.end(), [](const FileStamps* f) { return f->form.patterns.size() > 1; });
  const FileStamps& of = differing == pool.end() ? *pool.front() : **differing;
  throw DataError(fmt::format("{} is {}, or {}; state which by data.time_format = {} or {}", shown(of),
                              read_by(patterns[0], of.form.value), read_by(patterns[1], of.form.value), patterns[0],
                              patterns[1]));
}

/// Files whose format was found, in groups of equal pattern. Files with numbers and files with texts are in separate
/// groups.
std::map<std::tuple<bool, std::size_t, std::string>, Pool> pools_of(const std::vector<FileStamps>& forms) {
  std::map<std::tuple<bool, std::size_t, std::string>, Pool> pools;
  for (const FileStamps& of : forms)
    if (of.form.ground != Ground::none && of.form.ground != Ground::stated)
      pools[{of.form.ground == Ground::text, of.path, of.column}].push_back(&of);
  return pools;
}

}  // namespace

bool agree_on_stamps(const std::vector<FileStamps>& forms, std::vector<FilePlan>& plans) {
  bool changed = false;
  std::vector<std::string> decided;  // patterns that follow from the values
  const auto pools = pools_of(forms);
  std::map<const Pool*, std::vector<std::string>> common;
  for (const auto& [key, pool] : pools)
    if (std::get<bool>(key))
      if (const auto patterns = common[&pool] = common_patterns(pool); patterns.size() == 1)
        decided.push_back(patterns.front());
  for (const auto& [key, pool] : pools) {
    const bool is_text = std::get<bool>(key);
    const auto& path = std::get<1>(key);
    const auto& column = std::get<2>(key);
    TimeRequest agreed;
    if (is_text) {
      const std::vector<std::string>& patterns = common[&pool];
      const auto known = std::find_first_of(patterns.begin(), patterns.end(), decided.begin(), decided.end());
      if (patterns.size() > 1 && known == patterns.end()) refuse_ambiguous(pool, patterns);
      agreed.format = known == patterns.end() ? patterns.front() : *known;
    } else {
      agreed.unit = agreed_unit(pool);
    }
    const bool as_read = std::all_of(pool.begin(), pool.end(), [&](const FileStamps* of) {
      return is_text ? of->form.patterns.front() == agreed.format : of->form.unit == agreed.unit;
    });
    if (as_read) continue;
    changed = true;
    for (FilePlan& plan : plans)
      for (SourcePlan& source : plan.sources)
        if (TimeRequest& request = source.request.time; source.path == path && request.column == column) {
          request.unit = agreed.unit;
          request.format = agreed.format;
        }
  }
  return changed;
}

}  // namespace modebank
