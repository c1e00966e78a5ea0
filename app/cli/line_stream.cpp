#include "app/cli/line_stream.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>

#include "modebank/base/error.hpp"

namespace modebank::app {

namespace {

constexpr std::size_t longest_line = 1 << 20;

volatile std::sig_atomic_t stop_asked = 0;
sigset_t outside_mask;

void ask_to_stop(int) { stop_asked = 1; }

void handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

enum class Waited { input, quiet, stop };

timespec duration(double seconds) {
  const double whole = std::floor(seconds);
  return {static_cast<time_t>(whole), static_cast<long>(1e9 * (seconds - whole))};
}

/// Waits for input. Signals can arrive during the wait.
Waited wait_for_input(double wait_s) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  const timespec most = std::isfinite(wait_s) ? duration(wait_s) : timespec{};
  while (stop_asked == 0) {
    const int ready = ppoll(&input, 1, std::isfinite(wait_s) ? &most : nullptr, &outside_mask);
    if (ready == 0) return Waited::quiet;
    if (ready > 0 || errno != EINTR) return Waited::input;  // the next `read` reports the error
  }
  return Waited::stop;
}

}  // namespace

LineStream::LineStream() {
  stop_asked = 0;
  sigset_t held;
  sigemptyset(&held);
  sigaddset(&held, SIGINT);
  sigaddset(&held, SIGTERM);
  sigprocmask(SIG_BLOCK, &held, &outside_mask);
  sigdelset(&outside_mask, SIGINT);
  sigdelset(&outside_mask, SIGTERM);
  handle(SIGINT, ask_to_stop);
  handle(SIGTERM, ask_to_stop);
  handle(SIGPIPE, SIG_IGN);
}

LineStream::~LineStream() {
  handle(SIGINT, SIG_DFL);
  handle(SIGTERM, SIG_DFL);
  handle(SIGPIPE, SIG_DFL);
  sigprocmask(SIG_SETMASK, &outside_mask, nullptr);
}

LineStream::Filled LineStream::fill(double wait_s) {
  buffer_.erase(0, start_);
  start_ = 0;
  std::array<char, 65536> chunk;
  for (Waited waited; (waited = wait_for_input(wait_s)) != Waited::stop;) {
    if (waited == Waited::quiet) return Filled::quiet;
    const ssize_t count = read(STDIN_FILENO, chunk.data(), chunk.size());
    if (count > 0) {
      buffer_.append(chunk.data(), static_cast<std::size_t>(count));
      arrival_ = Clock::now();
      return Filled::some;
    }
    if (count == 0) return Filled::end;
    if (errno != EINTR && errno != EAGAIN)
      throw DataError(std::string("cannot read standard input: ") + std::strerror(errno));
  }
  cut_ = !buffer_.empty();
  buffer_.clear();
  return Filled::end;
}

LineStream::Got LineStream::next(std::string_view& line, double wait_s) {
  while (true) {
    const std::size_t end = buffer_.find('\n', start_);
    if (end != std::string::npos) {
      line = std::string_view(buffer_).substr(start_, end - start_);
      start_ = end + 1;
      waited_ = false;
      if (!discarding_ && line.size() <= longest_line) return Got::line;
      discarding_ = false;
      return Got::overlong;
    }
    if (!waited_) {
      waited_ = true;
      return Got::waiting;
    }
    if (ended_) return Got::end;
    if (buffer_.size() - start_ > longest_line) {
      buffer_.clear();
      start_ = 0;
      discarding_ = true;
    }
    const Filled filled = fill(wait_s);
    if (filled == Filled::some) continue;
    if (filled == Filled::quiet) return Got::quiet;
    ended_ = true;
    unended_ = start_ < buffer_.size() && !discarding_;
    if (unended_) buffer_ += '\n';
  }
}

bool write_out(std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = write(STDOUT_FILENO, text.data(), text.size());
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EPIPE) {
      return false;
    } else if (errno == EAGAIN) {
      pollfd output{STDOUT_FILENO, POLLOUT, 0};
      poll(&output, 1, -1);
    } else if (errno != EINTR) {
      throw DataError(std::string("cannot write standard output: ") + std::strerror(errno));
    }
  }
  return true;
}

}  // namespace modebank::app
