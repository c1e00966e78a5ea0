#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace modebank::app::view {

/// What a browser asks, as far as anything here depends on it. Headers that came several times are here several times.
struct Request {
  std::string method, target;
  std::vector<std::string> host, origin, fetch_site, cookie;
};

/// A file that is open and closes with its last holder.
class OpenFile {
 public:
  OpenFile() = default;
  explicit OpenFile(int descriptor);
  int descriptor() const { return held_ ? *held_ : -1; }
  explicit operator bool() const { return held_ != nullptr; }

 private:
  std::shared_ptr<const int> held_;
};

struct Answer {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  OpenFile file = {};  ///< instead of the body, where there is one
  std::string policy;  ///< Content-Security-Policy; empty: nothing at all is allowed
  std::vector<std::pair<std::string, std::string>> more = {};  ///< further headers
};

/// A page of one sentence; `text` may hold anything. `home`: with a link to the overview.
Answer sentence(unsigned status, const std::string& text, bool home);

}  // namespace modebank::app::view
