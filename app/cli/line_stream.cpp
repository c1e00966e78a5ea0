#include "app/cli/line_stream.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "modebank/base/error.hpp"

namespace modebank::app {

namespace {

constexpr std::size_t longest_line = 1 << 20;
constexpr int stop_signals[] = {SIGINT, SIGTERM};

volatile std::sig_atomic_t stop_asked = 0;
sigset_t outside_mask;

void ask_to_stop(int) { stop_asked = 1; }

void handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

/// Waits for input. Signals can arrive during the wait. Returns whether there is input; false if a signal asked to
/// stop.
bool wait_for_input() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (stop_asked == 0)
    if (ppoll(&input, 1, nullptr, &outside_mask) > 0 || errno != EINTR) return true;  // the next `read` reports errors
  return false;
}

}  // namespace

LineStream::LineStream() {
  stop_asked = 0;
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : stop_signals) sigaddset(&held, signal);
  sigprocmask(SIG_BLOCK, &held, &outside_mask);
  for (const int signal : stop_signals) {
    sigdelset(&outside_mask, signal);
    handle(signal, ask_to_stop);
  }
  handle(SIGPIPE, SIG_IGN);
}

LineStream::~LineStream() {
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) handle(signal, SIG_DFL);
  sigprocmask(SIG_SETMASK, &outside_mask, nullptr);
}

bool LineStream::fill() {
  buffer_.erase(0, start_);
  start_ = 0;
  std::array<char, 65536> chunk;
  while (wait_for_input()) {
    const ssize_t count = read(STDIN_FILENO, chunk.data(), chunk.size());
    if (count > 0) {
      buffer_.append(chunk.data(), static_cast<std::size_t>(count));
      return true;
    }
    if (count == 0) return false;
    if (errno != EINTR && errno != EAGAIN)
      throw DataError(std::string("cannot read standard input: ") + std::strerror(errno));
  }
  cut_ = !buffer_.empty();
  buffer_.clear();
  return false;
}

LineStream::Got LineStream::next(std::string_view& line) {
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
    if (fill()) continue;
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
