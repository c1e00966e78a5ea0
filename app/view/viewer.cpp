#include "app/view/viewer.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <boost/algorithm/string.hpp>

#include "app/report/page/assets.hpp"
#include "app/report/page/html_page.hpp"
#include "app/view/digest.hpp"
#include "ident/base/printable.hpp"

namespace modebank::app::view {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t pages_at_once = 2, digests_at_once = 2, digests_waiting = 16;
constexpr std::size_t longest_digest = 64 * 1024;

/// Of a run or a comparison; what their file says of itself holds, too.
const std::string& report_policy() {
  static const std::string policy = report::page_policy({assets::run_js(), assets::compare_js()});
  return policy;
}
const char* const overview_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; style-src-attr 'unsafe-inline'; connect-src 'self'; "
    "img-src data:";

Answer text(const std::string& type, std::string_view body, const std::string& policy = {}) {
  Answer answer;
  answer.type = type + "; charset=utf-8";
  answer.body = body;
  answer.policy = policy;
  return answer;
}

Answer page_in(const fs::path& folder) {
  const int file = ::open((folder / "page.html").c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return sentence(500, "The page is not there.", true);
  Answer answer = text("text/html", "", report_policy());
  answer.file = OpenFile(file);
  return answer;
}

/// Bytes that are no UTF-8 are replaced.
std::string dumped(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

json row_of(const Entry& entry) {
  constexpr std::int64_t ns_per_s = 1'000'000'000;
  json row = {{"id", entry.id},
              {"name", entry.name.filename().string()},
              {"folder", entry.name.parent_path().string()},
              {"bytes", entry.state.bytes},
              {"changed_s", entry.state.changed_ns / ns_per_s}};
  if (!entry.problem.empty()) row["problem"] = entry.problem;
  if (!entry.digest.is_null()) row["digest"] = entry.digest;
  return row;
}

}  // namespace

Viewer::Viewer(const fs::path& what, const fs::path& folder)
    : catalogue_(what), pages_(folder / "pages", pages_at_once), digests_(folder / "digests", digests_at_once) {}

void Viewer::tend() {
  pages_.tend();
  digests_.tend();
}

std::uint64_t Viewer::make_page(const std::vector<std::string>& ids, bool head, const Reply& reply) {
  catalogue_.look();
  std::vector<NamedFile> files;
  std::vector<std::string> arguments{"report"};
  for (const std::string& id : ids) {
    const Entry* entry = catalogue_.find(id);
    const NamedFile file = entry ? catalogue_.open(*entry) : NamedFile();
    if (!file.file) {
      reply(sentence(
          404, entry ? entry->name.string() + " is no longer there." : "There is no such archive (any more).", true));
      return 0;
    }
    files.push_back(file);
    arguments.push_back("./" + file.name.string());
  }
  if (head) {
    reply(text("text/html", "", report_policy()));
    return 0;
  }
  const std::vector<std::string> written{"-o", "../page.html", "--report.runs", "0"};
  arguments.insert(arguments.end(), written.begin(), written.end());
  return pages_.add(arguments, files, [reply](const std::string& failure, const fs::path& folder) {
    reply(failure.empty() ? page_in(folder) : sentence(500, "No page could be made: " + failure, true));
  });
}

void Viewer::read_digest(const std::string& id, Entry& entry) {
  const NamedFile file = catalogue_.open(entry);
  if (!file.file) return;  // the next look will miss it, too
  entry.asked = true;
  const FileState state = entry.state;
  digests_.add({"view", "--json", "./" + entry.name.string()}, {file},
               [this, id, state](const std::string& failure, const fs::path& folder) {
                 const auto found = catalogue_.entries().find(id);
                 if (found == catalogue_.entries().end() || found->second.state != state) return;
                 catalogue_.changed();
                 found->second.problem = printable(failure);
                 if (!failure.empty()) return;
                 try {
                   found->second.digest = checked_digest(beginning_of(folder / "out", longest_digest));
                 } catch (const std::exception& error) {
                   found->second.problem = error.what();
                 }
               });
}

void Viewer::read_digests() {
  std::size_t waiting = 0;
  for (const auto& [id, entry] : catalogue_.entries()) waiting += entry.open() && entry.asked ? 1 : 0;
  for (auto& [id, entry] : catalogue_.entries()) {
    if (waiting >= digests_waiting) return;
    if (!entry.open() || entry.asked) continue;
    read_digest(id, entry);
    ++waiting;
  }
}

std::string Viewer::overview_json(const std::string& seen) {
  catalogue_.look();
  read_digests();
  const std::string version = std::to_string(catalogue_.version());
  json overview = {{"title", catalogue_.title()}, {"version", version}, {"cut", catalogue_.cut()}};
  if (seen == version) return dumped(overview);
  overview["rows"] = json::array();
  for (const auto& [id, entry] : catalogue_.entries()) overview["rows"].push_back(row_of(entry));
  return dumped(overview);
}

std::uint64_t Viewer::answer(const Request& request, const Reply& reply) {
  const bool head = request.method == "HEAD";
  std::vector<std::string> parts;
  boost::split(parts, request.target, [](char c) { return c == '/' || c == '?'; });  // the first is empty
  const std::string& what = parts.at(1);
  if (request.target == "/" && catalogue_.is_one_archive())
    return make_page({catalogue_.entries().empty() ? "" : catalogue_.entries().begin()->first}, head, reply);
  if (what == "archive" && parts.size() == 3) return make_page({parts[2]}, head, reply);
  if (what == "compare" && parts.size() == 4) return make_page({parts[2], parts[3]}, head, reply);
  if (request.target == "/")
    reply(text("text/html", assets::overview_html(), overview_policy));
  else if (what == "overview.json" && parts.size() <= 3)
    reply(text("application/json", overview_json(parts.size() == 3 ? parts[2] : "")));
  else if (request.target == "/page.css")
    reply(text("text/css", assets::page_css()));
  else if (request.target == "/overview.js")
    reply(text("text/javascript", assets::overview_js()));
  else
    reply(sentence(404, "There is no such page.", true));
  return 0;
}

}  // namespace modebank::app::view
