#include "tests/fuzz/supervise.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
#include <stdexcept>
#include <thread>

#include "modebank/base/error.hpp"

namespace modebank::fuzz {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int finding_status = 77;
constexpr std::size_t most_input_bytes = std::size_t{4} << 20;
constexpr std::int64_t idle = -1;

/// What both processes see: the input at work, and how it goes.
struct Board {
  std::atomic<std::int64_t> began_ns;  ///< processor time of the process when the input began; idle between inputs
  std::atomic<std::uint64_t> next;     ///< input: first those of the corpus, then the made ones
  std::uint64_t taken, refused;
  double slowest_s, grown_megabytes;
  char reason[1000];   ///< of a finding
  char refusal[1000];  ///< what the last refused input was told
  std::size_t bytes;
  char input[most_input_bytes];
};

class SharedBoard {
 public:
  SharedBoard() : board_(mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (board_ == MAP_FAILED) throw std::runtime_error("no memory to share");
    new (board_) Board{};
    operator->()->began_ns = idle;
  }
  ~SharedBoard() { munmap(board_, sizeof(Board)); }
  SharedBoard(const SharedBoard&) = delete;
  SharedBoard& operator=(const SharedBoard&) = delete;
  Board* operator->() const { return static_cast<Board*>(board_); }

 private:
  void* board_;
};

std::int64_t nanoseconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

[[noreturn]] void give_up(Board& board, const std::string& reason) {
  std::strncpy(board.reason, reason.c_str(), sizeof board.reason - 1);
  _exit(finding_status);
}

void refuse(Board& board, const char* what) {
  ++board.refused;
  std::strncpy(board.refusal, what, sizeof board.refusal - 1);
}

/// Runs one input in this process; does not return from a finding that is an exception or too much memory.
void run_one(const Target& target, std::string_view input, Board& board) {
  board.bytes = std::min(input.size(), most_input_bytes);
  std::memcpy(board.input, input.data(), board.bytes);
  const double before = peak_megabytes();
  const std::int64_t began = nanoseconds(CLOCK_PROCESS_CPUTIME_ID);
  board.began_ns = began;
  try {
    target.run(input);
    ++board.taken;
  } catch (const ConfigurationError& error) {
    refuse(board, error.what());
  } catch (const DataError& error) {
    refuse(board, error.what());
  } catch (const std::exception& error) {
    give_up(board, fmt::format("an exception escapes: {}", error.what()));
  } catch (...) {
    give_up(board, "an exception escapes that is no std::exception");
  }
  const std::int64_t ended = nanoseconds(CLOCK_PROCESS_CPUTIME_ID);
  board.began_ns = idle;
  board.slowest_s = std::max(board.slowest_s, 1e-9 * static_cast<double>(ended - began));
  const double grown = peak_megabytes() - before;
  board.grown_megabytes = std::max(board.grown_megabytes, grown);
  if (grown > most_megabytes) give_up(board, fmt::format("{:.0f} MB for one input", grown));
}

/// More memory is never had, so that a finding does not take the machine along. The address sanitizer needs all
/// addresses, and has limits of its own.
void limit_memory() {
#ifndef __SANITIZE_ADDRESS__
  constexpr rlim_t most = rlim_t{4} << 30;
  const rlimit limit{most, most};
  setrlimit(RLIMIT_AS, &limit);
#endif
}

/// The process under test: inputs from board.next on.
void work(const Target& target, const std::vector<std::string>& known, const Effort& effort, Clock::time_point end,
          Board& board) {
  limit_memory();
  for (const std::uint64_t last = known.size() + effort.count; board.next < last; ++board.next) {
    if (effort.seconds > 0.0 && Clock::now() > end) break;
    const std::uint64_t i = board.next;
    if (i < known.size()) {
      run_one(target, known[i], board);
      continue;
    }
    Random random(effort.seed, effort.first + i - known.size());
    run_one(target, target.make(random), board);
  }
}

/// Waits for the process, which is ended when an input takes too long. Returns its status and adds its processor time.
int watch(pid_t child, Board& board, Outcome& outcome) {
  clockid_t clock{};
  clock_getcpuclockid(child, &clock);
  std::int64_t known_began = idle;
  for (;;) {
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, WNOHANG, &usage) == child) {
      outcome.processor_s += static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                             1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
      return status;
    }
    const std::int64_t began = board.began_ns;
    const bool same = began != idle && began == known_began;
    known_began = began;
    if (same && 1e-9 * static_cast<double>(nanoseconds(clock) - began) > most_processor_s) {
      std::strncpy(board.reason, "more than 20 s of processor time", sizeof board.reason - 1);
      kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::string reason_of(int status, const Board& board) {
  if (board.reason[0] != '\0') return board.reason;
  if (WIFSIGNALED(status)) return fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("exit status {} (a sanitizer's report is above)", WEXITSTATUS(status));
}

/// Processes of one target until all inputs are through.
class Campaign {
 public:
  Campaign(const Target& target, const Effort& effort, std::vector<std::string> known)
      : target_(target), effort_(effort), known_(std::move(known)) {}

  Outcome run() {
    const auto end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(effort_.seconds));
    while (outcome_.findings < effort_.most_findings) {
      board_->reason[0] = '\0';
      board_->began_ns = idle;
      std::fflush(nullptr);
      const pid_t child = fork();
      if (child < 0) throw std::runtime_error("fork failed");
      if (child == 0) serve(end);
      const int status = watch(child, *board_.operator->(), outcome_);
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
      report(status);
      ++board_->next;
    }
    outcome_.inputs = board_->next;
    outcome_.taken = board_->taken;
    outcome_.refused = board_->refused;
    outcome_.slowest_s = board_->slowest_s;
    outcome_.most_megabytes = board_->grown_megabytes;
    outcome_.refusal = board_->refusal;
    return outcome_;
  }

 private:
  /// The process under test, to its end: nothing of the parent's is undone here.
  [[noreturn]] void serve(Clock::time_point end) {
    try {
      work(target_, known_, effort_, end, *board_.operator->());
    } catch (const std::exception& error) {
      give_up(*board_.operator->(), fmt::format("no input could be made: {}", error.what()));
    }
    std::exit(0);  // the address sanitizer looks for leaks
  }

  void report(int status) {
    ++outcome_.findings;
    const std::uint64_t i = board_->next;
    const bool is_known = i < known_.size();
    const std::uint64_t iteration = effort_.first + i - known_.size();
    const std::string place =
        is_known ? fmt::format("corpus {}", i) : fmt::format("seed {} iteration {}", effort_.seed, iteration);
    const std::filesystem::path file =
        effort_.findings / (is_known ? fmt::format("{}_corpus_{}", target_.name, i)
                                     : fmt::format("{}_{}_{}", target_.name, effort_.seed, iteration));
    std::ofstream(file, std::ios::binary).write(board_->input, static_cast<std::streamsize>(board_->bytes));
    fmt::print("FINDING {} {}: {}; its input: {}\n", target_.name, place, reason_of(status, *board_.operator->()),
               file.string());
  }

  const Target& target_;
  const Effort& effort_;
  std::vector<std::string> known_;
  SharedBoard board_;
  Outcome outcome_;
};

}  // namespace

Outcome fuzz(const Target& target, const Effort& effort) { return Campaign(target, effort, corpus(target.name)).run(); }

bool replay(const Target& target, const std::string& input, const std::string& name) {
  Effort effort;
  effort.findings = std::filesystem::temp_directory_path();
  const Outcome outcome = Campaign(target, effort, {input}).run();
  const char* what = outcome.findings > 0 ? "FINDING" : outcome.taken > 0 ? "taken" : "refused";
  fmt::print("{} {}: {}, {:.3f} s, {:.0f} MB{}{}\n", target.name, name, what, outcome.slowest_s, outcome.most_megabytes,
             outcome.refusal.empty() ? "" : ": ", outcome.refusal);
  return outcome.findings == 0;
}

}  // namespace modebank::fuzz
