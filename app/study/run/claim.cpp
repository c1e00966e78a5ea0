#include "app/study/run/claim.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <ctime>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>

#include "io/files/replace_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

double seconds_of(const timespec& time) {
  constexpr double ns = 1e-9;
  return static_cast<double>(time.tv_sec) + ns * static_cast<double>(time.tv_nsec);
}

/// State of a process, read from /proc.
struct ProcessState {
  char state = 0;
  pid_t parent = 0;
  long long start = 0;  ///< in clock ticks since the start of the machine
};

std::optional<ProcessState> process_state(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string text;
  if (!std::getline(file, text)) return std::nullopt;
  std::istringstream fields(text.substr(text.rfind(')') + 1));  // the fields start after the last ')': the program's
                                                                // name before it may contain any character
  ProcessState found;
  fields >> found.state >> found.parent;
  constexpr int skipped = 17;  // number of fields between the parent and the start time
  long long number = 0;
  for (int i = 0; i < skipped; ++i) fields >> number;
  if (!(fields >> found.start)) return std::nullopt;
  return found;
}

/// The machine and its namespace of process numbers. The namespace matters, because each container has its own.
std::string this_host() {
  std::array<char, 256> name{}, numbers{};
  ::gethostname(name.data(), name.size() - 1);
  if (::readlink("/proc/self/ns/pid", numbers.data(), numbers.size() - 1) < 0) numbers[0] = '\0';
  return fmt::format("{} {}", name.data(), numbers.data());
}

/// A process that has ended but was not reaped does not count as gone, because its parent must still finish its work.
bool is_gone(pid_t process, long long start) {
  const std::optional<ProcessState> found = process_state(process);
  if (!found || found->start != start) return true;
  return (found->state == 'Z' || found->state == 'X') && found->parent != ::getppid();
}

std::string own_text() {
  const std::optional<ProcessState> own = process_state(::getpid());
  return nlohmann::json{{"host", this_host()},
                        {"process", ::getpid()},
                        {"start", own ? own->start : 0},
                        {"time", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))}}
             .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) +
         "\n";
}

struct FoundClaim {
  std::string text;
  double time_s = 0.0;  ///< time by the folder's clock
};

/// Reads the file again, so that a network file system does not answer from its cache. Nullopt without a claim.
std::optional<FoundClaim> read_claim(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return std::nullopt;
  std::array<char, 4096> text{};
  struct stat about {};
  const ssize_t bytes = ::read(file, text.data(), text.size());
  const bool known = ::fstat(file, &about) == 0;
  ::close(file);
  if (!known) return std::nullopt;
  return FoundClaim{std::string(text.data(), static_cast<std::size_t>(std::max<ssize_t>(bytes, 0))),
                    seconds_of(about.st_mtim)};
}

struct Holder {
  std::string host;
  pid_t process = 0;
  long long start = 0;
};

/// Nullopt if the text is not that of a claim.
std::optional<Holder> holder_of(const std::string& text) try {
  const auto claim = nlohmann::json::parse(text);
  return Holder{claim.at("host"), claim.at("process"), claim.at("start")};
} catch (const nlohmann::json::exception&) {
  return std::nullopt;
}

bool is_over(const FoundClaim& claim, double now_s) {
  // A time in the future means that the folder's clock was set back after the claim was written.
  if (std::abs(now_s - claim.time_s) > Claim::lasts_s) return true;
  const std::optional<Holder> holder = holder_of(claim.text);
  return holder && holder->host == this_host() && is_gone(holder->process, holder->start);
}

/// A claim file with a temporary name. It gets the final name later.
class Proposal {
 public:
  Proposal(const fs::path& target, const std::string& text) : path_(temporary_path(target)), target_(target) {
    std::ofstream file(path_, std::ios::binary);
    file << text << std::flush;
    struct stat about {};
    if (!file || ::stat(path_.c_str(), &about) != 0) {
      const std::string reason = std::generic_category().message(errno);
      std::error_code ignored;
      fs::remove(path_, ignored);
      throw DataError(fmt::format("cannot write {}: {}", target.string(), reason));
    }
    time_s_ = seconds_of(about.st_mtim);
  }
  ~Proposal() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  Proposal(const Proposal&) = delete;
  Proposal& operator=(const Proposal&) = delete;

  double time_s() const { return time_s_; }

  /// Takes the final name in one step, if this name is free.
  bool enter() const {
    if (::link(path_.c_str(), target_.c_str()) == 0) return true;
    const int reason = errno;
    std::error_code error;
    if (reason == EEXIST)
      return fs::hard_link_count(path_, error) > 1 && !error;  // a network file system may have executed the link twice
    // The file system has no hard links.
    if (fs::exists(fs::symlink_status(target_, error))) return false;
    replace();
    return true;
  }
  void replace() const {
    std::error_code error;
    fs::rename(path_, target_, error);
    if (error) throw DataError(fmt::format("cannot write {}: {}", target_.string(), error.message()));
  }

 private:
  fs::path path_, target_;
  double time_s_ = 0.0;
};

}  // namespace

/// The claim file, and a thread that renews it.
struct Claim::Held {
  Held(fs::path where, std::string what)
      : path(std::move(where)), text(std::move(what)), renewal([this] { renew(); }) {}
  ~Held() {
    {
      const std::lock_guard lock(guard);
      over = true;
    }
    ended.notify_all();
    renewal.join();
    if (const auto there = read_claim(path); !there || there->text != text) return;
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

  void renew() {
    std::unique_lock lock(guard);
    while (!ended.wait_for(lock, std::chrono::duration<double>(renewed_after_s), [this] { return over; }))
      ::utimensat(AT_FDCWD, path.c_str(), nullptr, AT_SYMLINK_NOFOLLOW);  // sets the present time of the file system's
                                                                          // clock
  }

  fs::path path;
  std::string text;
  std::mutex guard;
  std::condition_variable ended;
  bool over = false;
  std::thread renewal;  // must be the last member, because the thread uses all others
};

Claim::Claim(std::unique_ptr<Held> held) : held_(std::move(held)) {}
Claim::~Claim() = default;
Claim::Claim(Claim&&) noexcept = default;
Claim& Claim::operator=(Claim&&) noexcept = default;

std::optional<Claim> Claim::take(const fs::path& path) {
  const std::string text = own_text();
  remove_link(path);
  const Proposal proposal(path, text);
  if (!proposal.enter()) {
    const auto other = read_claim(path);
    if (!other || !is_over(*other, proposal.time_s())) return std::nullopt;
    proposal.replace();
    const auto now = read_claim(path);
    if (!now || now->text != text)
      return std::nullopt;  // two processes took the claim over at the same time, and the later one has it
  }
  return Claim(std::make_unique<Held>(path, text));
}

Claim Claim::wait_for(const fs::path& path) {
  for (;;) {
    if (auto claim = take(path)) return std::move(*claim);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

void Claim::end_of(pid_t process, const fs::path& path) {
  const auto there = read_claim(path);
  if (!there) return;
  const std::optional<Holder> holder = holder_of(there->text);
  std::error_code ignored;
  if (holder && holder->host == this_host() && holder->process == process) fs::remove(path, ignored);
}

}  // namespace modebank::app
