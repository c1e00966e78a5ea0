#include "app/config/edit_file.hpp"

#include <algorithm>
#include <boost/algorithm/string.hpp>

namespace modebank::app {
namespace {

/// A line of a file, with the section that contains it.
struct Line {
  std::string text, section, name;  ///< name: the key that the line sets, or empty
  bool blank = false;
};

std::vector<Line> lines_of(const std::string& text) {
  std::vector<std::string> raw;
  boost::split(raw, text, [](char c) { return c == '\n'; });
  if (!raw.empty() && raw.back().empty()) raw.pop_back();
  std::vector<Line> lines;
  std::string section;
  for (const std::string& line : raw) {
    std::string content = boost::trim_copy(line.substr(0, line.find('#')));
    if (lines.empty() && content.rfind("\xEF\xBB\xBF", 0) == 0) content.erase(0, 3);
    const bool heads = content.size() > 2 && content.front() == '[' && content.back() == ']';
    if (heads) section = content.substr(1, content.size() - 2);
    const std::size_t equal_sign = content.find('=');
    const bool sets = !heads && equal_sign != std::string::npos;
    lines.push_back(
        {line, section, sets ? boost::trim_copy(content.substr(0, equal_sign)) : "", boost::trim_copy(line).empty()});
  }
  return lines;
}

std::string key_of(const Line& line) { return line.section.empty() ? line.name : line.section + "." + line.name; }

std::string written(const KeyEdit& edit, const std::string& name) {
  std::string text = edit.comment.empty() ? "" : "# " + edit.comment + "\n";
  for (const std::string& value : edit.values) text += name + " =" + (value.empty() ? "" : " " + value) + "\n";
  boost::trim_right_if(text, boost::is_any_of("\n"));
  return text;
}

/// Replaces the lines that set the key. Returns false if there are none.
bool replace_key(std::vector<Line>& lines, const KeyEdit& edit) {
  bool found = false;
  for (Line& line : lines) {
    if (line.name.empty() || key_of(line) != edit.key) continue;
    line.text = "# was: " + boost::trim_copy(line.text) + (found ? "" : "\n" + written(edit, line.name));
    found = true;
  }
  return found;
}

void add_key(std::vector<Line>& lines, const KeyEdit& edit) {
  const std::string section = edit.key.substr(0, edit.key.find('.')), name = edit.key.substr(section.size() + 1);
  const auto last = std::find_if(lines.rbegin(), lines.rend(),
                                 [&](const Line& line) { return line.section == section && !line.blank; });
  if (last != lines.rend()) {
    lines.insert(last.base(), {written(edit, name), section, name, false});
    return;
  }
  lines.push_back({"\n[" + section + "]", section, "", false});
  lines.push_back({written(edit, name), section, name, false});
}

}  // namespace

std::string edited_text(const std::string& text, const std::vector<KeyEdit>& edits) {
  std::vector<Line> lines = lines_of(text);
  for (const KeyEdit& edit : edits)
    if (!replace_key(lines, edit)) add_key(lines, edit);
  std::string result;
  for (const Line& line : lines) result += line.text + "\n";
  return result;
}

}  // namespace modebank::app
