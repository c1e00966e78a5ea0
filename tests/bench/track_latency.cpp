// track_latency PROGRAM [SECONDS]: time from an input line to the output line of `modebank track`, over pipes at 1 kHz
// with a bank of 25 modes. A program that only echoes lines runs for comparison. Every millisecond each program gets a
// line, in alternating order. Afterwards the filter's step alone is measured at the same rate.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "filter/step/bank_filter.hpp"
#include "io/archive/archive.hpp"
#include "tests/bench/bench_bank.hpp"
#include "tests/bench/bench_data.hpp"

namespace {

using Clock = std::chrono::steady_clock;

/// Echoes every line of its input.
int echo() {
  char buffer[65536];
  for (ssize_t count; (count = read(STDIN_FILENO, buffer, sizeof buffer)) > 0;)
    if (write(STDOUT_FILENO, buffer, static_cast<std::size_t>(count)) != count) return 1;
  return 0;
}

class Child {
 public:
  explicit Child(std::vector<std::string> words) {
    int to[2], from[2];
    if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if ((child_ = fork()) == 0) {
      dup2(to[0], STDIN_FILENO);
      dup2(from[1], STDOUT_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(to[0]);
    close(from[1]);
    to_ = to[1];
    from_ = from[0];
  }
  ~Child() {
    close(to_);
    close(from_);
    waitpid(child_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Microseconds from a line to its answer, which is stored in `answer`.
  double ask(const std::string& line) {
    const auto begin = Clock::now();
    if (write(to_, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
      throw std::runtime_error("write failed");
    answer.clear();
    char buffer[65536];
    while (answer.empty() || answer.back() != '\n') {
      const ssize_t count = read(from_, buffer, sizeof buffer);
      if (count <= 0) throw std::runtime_error("the program has ended");
      answer.append(buffer, static_cast<std::size_t>(count));
    }
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  }
  std::string answer;

 private:
  pid_t child_ = -1;
  int to_ = -1, from_ = -1;
};

double quantile(std::vector<double> values, double p) {
  const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::string sample_line(int k) {
  return fmt::format("{},{},{},{}\n", 0.001 * (k + 1), 0.1 * std::sin(0.01 * k), 0.2 * std::cos(0.013 * k),
                     0.2 * std::sin(0.017 * k));
}

}  // namespace

int main(int argc, char** argv) try {
  using namespace modebank;
  if (argc > 1 && std::string(argv[1]) == "--echo") return echo();
  if (argc < 2) return fmt::print(stderr, "usage: track_latency PROGRAM [SECONDS]\n"), 2;
  std::signal(SIGPIPE, SIG_IGN);
  const int ticks = 1000 * (argc > 2 ? std::atoi(argv[2]) : 20);
  Archive archive;
  archive.bank = bench::make_bank(25);
  archive.bank->dt_s = 0.001;
  archive.config = "[data]\nstate = wz\ninput = velL, velR\ntime = time\n";
  archive.provenance.created = "bench";
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("track_latency.{}.h5", getpid())).string();
  write_archive(path, archive);

  std::vector<double> track_us, echo_us, step_us;
  {
    Child track({argv[1], "track", path}), plain({argv[0], "--echo"});
    track.ask("time,wz,velL,velR\n");
    const auto begin = Clock::now();
    for (int k = 0; k < ticks; ++k) {
      std::this_thread::sleep_until(begin + std::chrono::milliseconds(k));
      const std::string line = sample_line(k);
      if (k % 2 == 0) track_us.push_back(track.ask(line));
      echo_us.push_back(plain.ask(line));
      if (k % 2 != 0) track_us.push_back(track.ask(line));
      bench::check(plain.answer == line, "echo");
      bench::check(std::count(track.answer.begin(), track.answer.end(), ',') == 10 + 25, "fields of the answer");
    }
  }
  std::filesystem::remove(path);
  BankFilter filter(*archive.bank, {});
  const auto begin = Clock::now();
  for (int k = 0; k < ticks; ++k) {
    std::this_thread::sleep_until(begin + std::chrono::milliseconds(k));
    const Eigen::Vector2d u(0.2 * std::cos(0.013 * k), 0.2 * std::sin(0.017 * k));
    const Eigen::VectorXd y = Eigen::VectorXd::Constant(1, 0.1 * std::sin(0.01 * k));
    const auto before = Clock::now();
    const FilterEstimate& estimate = filter.step(0.001 * (k + 1), u, y);
    step_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - before).count());
    bench::check(std::isfinite(estimate.state(0)), "estimate");
  }
  fmt::print("{:<10} {:>10} {:>10} {:>10}\n", "[us]", "median", "99.9 %", "largest");
  for (const auto& [name, values] :
       {std::pair("echo", &echo_us), std::pair("track", &track_us), std::pair("step", &step_us)})
    fmt::print("{:<10} {:>10.1f} {:>10.1f} {:>10.1f}\n", name, quantile(*values, 0.5), quantile(*values, 0.999),
               quantile(*values, 1.0));
  fmt::print("track / echo: median {:.2f}, 99.9 % {:.2f}\n", quantile(track_us, 0.5) / quantile(echo_us, 0.5),
             quantile(track_us, 0.999) / quantile(echo_us, 0.999));
  return 0;
} catch (const std::exception& error) {
  return fmt::print(stderr, "track_latency: {}\n", error.what()), 1;
}
