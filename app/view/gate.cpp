#include "app/view/gate.hpp"

#include <fmt/format.h>

#include <utility>

#include "app/view/secret.hpp"

namespace modebank::app::view {
namespace {

constexpr std::string_view token_query = "/?token=";
constexpr std::size_t longest_target = 200;

/// Calls `see` with every NAME=VALUE of the Cookie headers.
template <class See>
void each_cookie(const std::vector<std::string>& headers, See see) {
  for (const std::string_view header : headers)
    for (std::size_t begin = 0; begin < header.size();) {
      const std::size_t end = std::min(header.find(';', begin), header.size());
      std::string_view pair = header.substr(begin, end - begin);
      while (!pair.empty() && pair.front() == ' ') pair.remove_prefix(1);
      if (const auto equals = pair.find('='); equals != std::string_view::npos)
        see(pair.substr(0, equals), pair.substr(equals + 1));
      begin = end + 1;
    }
}

}  // namespace

Gate::Gate(unsigned port, std::function<void(const std::string& address)> announce)
    : authority_(fmt::format("127.0.0.1:{}", port)),
      cookie_name_(fmt::format("modebank_{}", port)),  // browsers share cookies among all ports of a machine
      cookie_(random_secret()),
      announce_(std::move(announce)) {
  new_token();
}

void Gate::new_token() {
  token_ = random_secret();
  announce_(fmt::format("http://{}{}{}", authority_, token_query, token_));
}

std::optional<Answer> Gate::stop_stranger(const Request& request) const {
  if (request.method != "GET" && request.method != "HEAD") {
    Answer answer = sentence(405, "This server is only read: GET and HEAD.", false);
    answer.more.emplace_back("Allow", "GET, HEAD");
    return answer;
  }
  // A name that a stranger's name server has pointed here would make his page one of ours (DNS rebinding).
  if (request.host.size() != 1 || request.host.front() != authority_)
    return sentence(421, fmt::format("This server is http://{} and answers to no other name.", authority_), false);
  if (request.origin.size() > 1 || (!request.origin.empty() && request.origin.front() != "http://" + authority_))
    return sentence(403, "Pages of other sites get nothing here.", false);
  // Another port of this machine is the same site to a browser, and its pages may ask with our cookie.
  for (const std::string& site : request.fetch_site)
    if (site != "same-origin" && site != "none")
      return sentence(403, "Pages of other sites get nothing here: type or paste the address that modebank printed.",
                      false);
  if (request.target.size() > longest_target) return sentence(414, "There is no address as long as this.", false);
  if (request.target.empty() || request.target.front() != '/')
    return sentence(400, "This server fetches nothing from elsewhere.", false);
  return std::nullopt;
}

bool Gate::knows_cookie(const Request& request) const {
  bool known = false;
  each_cookie(request.cookie, [&](std::string_view name, std::string_view value) {
    if (name == cookie_name_ && same_secret(value, cookie_)) known = true;
  });
  return known;
}

Answer Gate::let_in(bool with_cookie) {
  Answer answer = sentence(303, "", false);
  answer.more.emplace_back("Location", "/");
  if (with_cookie)
    answer.more.emplace_back("Set-Cookie",
                             fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/", cookie_name_, cookie_));
  return answer;
}

std::optional<Answer> Gate::stop(const Request& request) {
  if (std::optional<Answer> refused = stop_stranger(request)) return refused;
  const std::string_view target = request.target;
  const bool has_token = target.substr(0, token_query.size()) == token_query;
  if (knows_cookie(request)) return has_token ? std::optional(let_in(false)) : std::nullopt;
  // HEAD is what programs ask that only look whether an address is there: the token stays.
  if (has_token && same_secret(target.substr(token_query.size()), token_)) {
    if (request.method == "HEAD") return let_in(false);
    new_token();
    return let_in(true);
  }
  return sentence(403,
                  has_token ? "This address has been used or is wrong: modebank has printed the one that opens next."
                            : "Open the address with the token that modebank printed.",
                  false);
}

}  // namespace modebank::app::view
