#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/view/message.hpp"

namespace modebank::app::view {

/// Who may ask. The address that the program prints has a token that opens once: it is exchanged for a cookie, and the
/// next one is announced. Everything else needs the cookie, so that other users of the machine, who reach the port, and
/// pages of other sites, which the browser lets ask, get nothing.
class Gate {
 public:
  /// `announce` is given each token that opens.
  Gate(unsigned port, std::function<void(const std::string& address)> announce);

  /// The answer to a request that goes no further; none to one of the user's own pages.
  std::optional<Answer> stop(const Request& request);

 private:
  std::optional<Answer> stop_stranger(const Request& request) const;
  bool knows_cookie(const Request& request) const;
  Answer let_in(bool with_cookie);
  void new_token();

  std::string authority_, cookie_name_, cookie_, token_;
  std::function<void(const std::string&)> announce_;
};

}  // namespace modebank::app::view
