#include "io/recording/alternating_frames.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unordered_set>

#include "ident/base/printable.hpp"

namespace modebank {

std::vector<std::string> frame_columns(const LogTopic& topic) {
  std::vector<std::string> children, parents;
  for (const MessageColumn& column : topic.columns) {
    const std::size_t bracket = column.path.find('[', topic.name.size());
    const bool first = bracket == std::string::npos || column.path.compare(bracket, 3, "[0]") == 0;
    if (column.form != MessageColumn::Form::text || !first) continue;
    if (column.path.ends_with(".child_frame_id")) children.push_back(column.path);
    if (column.path.ends_with(".frame_id")) parents.push_back(column.path);
  }
  children.insert(children.end(), parents.begin(), parents.end());
  return children;
}

std::string alternation_text(const LogTopic& topic, const std::string& column, const std::vector<std::string>& frames) {
  constexpr std::size_t shown = 4, one_in = 100;
  std::vector<std::string> names;
  std::unordered_set<std::string_view> seen;
  std::size_t returns = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const bool fresh = seen.insert(frames[k]).second;
    if (fresh && names.size() < shown) names.push_back(printable_name(frames[k]));
    if (!fresh && frames[k] != frames[k - 1]) ++returns;
  }
  if (returns <= frames.size() / one_in) return {};
  return fmt::format(
      "topic {}: its messages alternate between {} frames ({}{}); set data.run = {} for one run per frame", topic.name,
      seen.size(), fmt::join(names, ", "), seen.size() > shown ? ", ..." : "", column);
}

}  // namespace modebank
