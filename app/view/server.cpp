#include "app/view/server.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <csignal>
#include <list>

#include "app/view/gate.hpp"
#include "app/view/viewer.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

// Boost.Beast, not cpp-httplib: one thread drives all connections, a deadline holds for a whole header or answer (the
// other's timeouts begin anew with each byte, so a client that sends one a second keeps a thread for ever), the limits
// of header and body are the parser's own, and Debian's package is one that modebank needs anyway.
namespace modebank::app::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace fs = std::filesystem;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t most_connections = 16;
constexpr std::uint32_t longest_header = 8 * 1024;
constexpr std::chrono::seconds header_time{5}, answer_time{120};  // of a page through a slow tunnel, too
constexpr std::chrono::seconds page_time{90};                     // waiting for others' pages, and for its own
constexpr std::chrono::milliseconds tending{100};

class Connection;

/// What all connections share.
struct Shared {
  Gate& gate;
  Viewer& viewer;
  std::list<std::weak_ptr<Connection>> connections = {};  ///< the oldest first
};

std::vector<std::string> values_of(const http::fields& headers, beast::string_view name) {
  std::vector<std::string> values;
  const auto [begin, end] = headers.equal_range(name);
  for (auto each = begin; each != end; ++each) values.emplace_back(each->value());
  return values;
}

Request request_of(const http::request<http::empty_body>& given) {
  return {std::string(given.method_string()), std::string(given.target()),        values_of(given, "Host"),
          values_of(given, "Origin"),         values_of(given, "Sec-Fetch-Site"), values_of(given, "Cookie")};
}

template <class Response>
void set_headers(Response& response, const Answer& answer) {
  response.set(http::field::content_type, answer.type);
  response.set("Content-Security-Policy", (answer.policy.empty() ? "default-src 'none'" : answer.policy) +
                                              "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cache-Control", "no-store");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  for (const auto& [name, value] : answer.more) response.set(name, value);
  response.keep_alive(false);  // sixteen connections are enough where none waits for a next request
}

/// One request and its answer.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Shared& shared) : stream_(std::move(socket)), shared_(shared) {}

  void read() {
    parser_.header_limit(longest_header);
    parser_.body_limit(0);
    stream_.expires_after(header_time);
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](error_code error, std::size_t) { self->take(error); });
  }
  bool reads() const { return !taken_; }
  void close() {
    error_code none;
    stream_.socket().close(none);
  }

 private:
  void take(error_code error) {
    taken_ = true;
    if (error == http::error::header_limit) return write(sentence(431, "The header is too long.", false));
    if (error == http::error::body_limit) return write(sentence(413, "A request has no body here.", false));
    if (error && error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message)
      return write(sentence(400, "This is no request.", false));
    if (error) return close();
    head_ = parser_.get().method() == http::verb::head;
    const Request request = request_of(parser_.get());
    if (const std::optional<Answer> stopped = shared_.gate.stop(request)) return write(*stopped);
    stream_.expires_after(page_time);
    page_ = shared_.viewer.answer(request, [weak = weak_from_this()](Answer answer) {
      if (const auto self = weak.lock(); self && !self->answered_) self->write(std::move(answer));
    });
    if (!answered_) wait_for_end();
  }

  /// A browser that goes away, or reloads, gives up its page. Whatever it says meanwhile is no matter.
  void wait_for_end() {
    stream_.async_read_some(asio::buffer(&ignored_, 1), [self = shared_from_this()](error_code error, std::size_t) {
      if (self->answered_) return;
      if (!error) return self->wait_for_end();
      self->shared_.viewer.give_up(self->page_);
      self->close();
    });
  }

  void write(Answer answer) {
    answered_ = true;
    stream_.expires_after(answer_time);
    if (answer.file && !head_) return write_file(answer);
    auto response = std::make_shared<http::response<http::string_body>>(http::status(answer.status), 11);
    set_headers(*response, answer);
    response->content_length(answer.body.size());
    if (!head_) response->body() = std::move(answer.body);
    send(response);
  }

  void write_file(const Answer& answer) {
    auto response = std::make_shared<http::response<http::file_body>>(http::status(answer.status), 11);
    set_headers(*response, answer);
    http::file_body::value_type body;
    beast::file_posix file;
    file.native_handle(::dup(answer.file.descriptor()));
    error_code error;
    body.reset(std::move(file), error);
    if (error) return close();
    response->body() = std::move(body);
    response->prepare_payload();
    send(response);
  }

  template <class Response>
  void send(std::shared_ptr<Response> response) {
    auto serializer = std::make_shared<http::response_serializer<typename Response::body_type>>(*response);
    http::async_write(stream_, *serializer, [self = shared_from_this(), response, serializer](error_code, std::size_t) {
      error_code none;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, none);
      self->close();
    });
  }

  beast::tcp_stream stream_;
  Shared& shared_;
  beast::flat_buffer buffer_{longest_header};
  http::request_parser<http::empty_body> parser_;
  std::uint64_t page_ = 0;
  char ignored_ = 0;
  bool taken_ = false, head_ = false, answered_ = false;
};

/// Whether there is room for one more; who still has not said what he wants makes room, the longest waiting first.
bool make_room(std::list<std::weak_ptr<Connection>>& connections) {
  connections.remove_if([](const auto& each) { return each.expired(); });
  if (connections.size() < most_connections) return true;
  for (auto each = connections.begin(); each != connections.end(); ++each)
    if (const auto connection = each->lock(); connection && connection->reads()) {
      connection->close();
      connections.erase(each);
      return true;
    }
  return false;
}

void accept(tcp::acceptor& acceptor, asio::steady_timer& pause, Shared& shared) {
  acceptor.async_accept([&](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error && make_room(shared.connections)) {
      const auto connection = std::make_shared<Connection>(std::move(socket), shared);
      shared.connections.push_back(connection);
      connection->read();
    }
    if (!error) return accept(acceptor, pause, shared);
    pause.expires_after(tending);  // no descriptor is left, say
    pause.async_wait([&](error_code stopped) {
      if (!stopped) accept(acceptor, pause, shared);
    });
  });
}

void tend(asio::steady_timer& timer, Viewer& viewer) {
  timer.expires_after(tending);
  timer.async_wait([&](error_code stopped) {
    if (stopped) return;
    viewer.tend();
    tend(timer, viewer);
  });
}

void tend_at_once(asio::signal_set& ended, Viewer& viewer) {
  ended.async_wait([&](error_code stopped, int) {
    if (stopped) return;
    viewer.tend();
    tend_at_once(ended, viewer);
  });
}

/// Nobody else's folder.
class OwnFolder {
 public:
  OwnFolder() : path_(temporary_path(fs::temp_directory_path() / "modebank_view")) {
    if (::mkdir(path_.c_str(), S_IRWXU) != 0) throw std::system_error(errno, std::generic_category(), path_.string());
  }
  ~OwnFolder() {
    std::error_code none;
    fs::remove_all(path_, none);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

tcp::acceptor listen(asio::io_context& context, unsigned short port) {
  try {
    return {context, tcp::endpoint(asio::ip::address_v4::loopback(), port)};
  } catch (const boost::system::system_error& error) {
    throw ConfigurationError(fmt::format("--port {}: {}", port, error.code().message()));
  }
}

}  // namespace

void serve(const fs::path& what, const ServerOptions& options) {
  std::signal(SIGPIPE, SIG_IGN);
  const OwnFolder folder;
  Viewer viewer(what, folder.path());
  asio::io_context context(1);
  tcp::acceptor acceptor = listen(context, options.port);
  asio::signal_set stop(context, SIGINT, SIGTERM, SIGHUP), ended(context, SIGCHLD);
  stop.async_wait([&](error_code, int) { context.stop(); });
  Gate gate(acceptor.local_endpoint().port(), options.announce);
  Shared shared{gate, viewer};
  asio::steady_timer pause(context), timer(context);
  accept(acceptor, pause, shared);
  tend(timer, viewer);
  tend_at_once(ended, viewer);
  context.run();
}

}  // namespace modebank::app::view
