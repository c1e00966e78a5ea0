#include "app/study/run/worker_pool.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <utility>

#include "app/study/run/child_process.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// One packet from worker to parent; the message follows it.
struct ReportHead {
  int outcome = 0;
  double seconds = 0.0, log_score = 0.0;
  std::array<double, stage_count> stage_seconds{};
};

constexpr std::size_t longest_message = 4096;
constexpr char starts_waiting = 'w', goes_on = 'g';  // packets of one byte, before the report

std::string pack_report(const TrialReport& report) {
  const ReportHead head{static_cast<int>(report.outcome), report.seconds, report.log_score, report.stage_seconds};
  std::string packet(sizeof head, '\0');
  std::memcpy(packet.data(), &head, sizeof head);
  return packet + report.message.substr(0, longest_message);
}

TrialReport unpack_report(const std::string& packet) {
  ReportHead head;
  std::memcpy(&head, packet.data(), sizeof head);
  return {static_cast<TrialOutcome>(head.outcome), packet.substr(sizeof head), head.seconds, head.stage_seconds,
          head.log_score};
}

ssize_t receive(int channel, void* data, std::size_t bytes) {
  ssize_t received = 0;
  do {
    received = ::recv(channel, data, bytes, 0);
  } while (received < 0 && errno == EINTR);
  return received;
}

/// The life of a worker: trials in, reports out, until the parent closes its end.
[[noreturn]] void serve(int channel, const WorkerPool::MakeWork& make_work) {
  int status = 0;
  try {
    const WorkerPool::Work work = make_work([channel](bool waiting) {
      const char word = waiting ? starts_waiting : goes_on;
      static_cast<void>(::send(channel, &word, sizeof word, MSG_NOSIGNAL));
    });
    std::size_t trial = 0;
    while (receive(channel, &trial, sizeof trial) == sizeof trial) {
      const std::string packet = pack_report(work(trial));
      if (::send(channel, packet.data(), packet.size(), MSG_NOSIGNAL) < 0) break;
    }
  } catch (const std::exception& error) {
    const std::string packet = pack_report({TrialOutcome::broken, error.what(), 0.0, {}, 0.0});
    static_cast<void>(::send(channel, packet.data(), packet.size(), MSG_NOSIGNAL));
    status = 1;
  }
  ::_exit(status);  // what the parent will do at its exit is not ours to do
}

}  // namespace

WorkerPool::WorkerPool(std::size_t workers, double timeout_s, MakeWork make_work)
    : timeout_s_(timeout_s), make_work_(std::move(make_work)), workers_(workers) {}

WorkerPool::~WorkerPool() {
  for (Worker& worker : workers_)
    if (worker.process >= 0) end(worker, worker.trial.has_value());
}

bool WorkerPool::is_working() const {
  return std::any_of(workers_.begin(), workers_.end(), [](const Worker& worker) { return worker.trial.has_value(); });
}

void WorkerPool::start(Worker& worker) {
  int channels[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, channels) != 0)
    throw DataError("cannot make a socket for a worker: " + std::generic_category().message(errno));
  const pid_t child = fork_child();
  if (child == 0) {
    ::close(channels[0]);
    for (const Worker& other : workers_)
      if (other.channel >= 0) ::close(other.channel);
    serve(channels[1], make_work_);
  }
  ::close(channels[1]);
  worker = {child, channels[0], {}, {}, {}};
}

std::string WorkerPool::end(Worker& worker, bool by_force) {
  if (by_force) ::kill(worker.process, SIGKILL);
  ::close(worker.channel);
  int status = 0;
  while (::waitpid(worker.process, &status, 0) < 0 && errno == EINTR) continue;
  worker = {};
  return how_it_ended(status);
}

void WorkerPool::give(std::size_t index, std::size_t trial) {
  Worker& worker = workers_[index];
  if (worker.process < 0) start(worker);
  worker.trial = trial;
  worker.since = Clock::now();
  worker.waiting_from.reset();
  // A worker that is gone shows when its answer is awaited.
  static_cast<void>(::send(worker.channel, &trial, sizeof trial, MSG_NOSIGNAL));
}

std::optional<WorkerPool::Finished> WorkerPool::collect(std::size_t index) {
  Worker& worker = workers_[index];
  const std::size_t trial = *worker.trial;
  std::string packet(sizeof(ReportHead) + longest_message, '\0');
  const ssize_t received = receive(worker.channel, packet.data(), packet.size());
  if (received == 1) {
    if (packet[0] == starts_waiting)
      worker.waiting_from = Clock::now();
    else if (worker.waiting_from)
      worker.since += Clock::now() - *std::exchange(worker.waiting_from, std::nullopt);
    return std::nullopt;
  }
  if (received < static_cast<ssize_t>(sizeof(ReportHead))) {
    const std::string why = end(worker, false);
    return Finished{index, trial, {TrialOutcome::failed, why, 0.0, {}, 0.0}, true};
  }
  worker.trial.reset();
  packet.resize(static_cast<std::size_t>(received));
  return Finished{index, trial, unpack_report(packet), false};
}

std::optional<std::size_t> WorkerPool::first_due() const {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < workers_.size() && timeout_s_ > 0.0; ++i)
    if (workers_[i].trial && !workers_[i].waiting_from && (!first || workers_[i].since < workers_[*first].since))
      first = i;
  return first;
}

WorkerPool::Finished WorkerPool::stop_overdue(std::size_t index) {
  const std::size_t trial = *workers_[index].trial;
  end(workers_[index], true);
  TrialReport report;
  report.outcome = TrialOutcome::failed;
  report.message = fmt::format("it took longer than study.timeout_s = {}", timeout_s_);
  report.seconds = timeout_s_;
  return {index, trial, report, true};
}

std::optional<WorkerPool::Finished> WorkerPool::wait(double patience_s) {
  const auto seconds_since = [](Clock::time_point time) {
    return std::chrono::duration<double>(Clock::now() - time).count();
  };
  const Clock::time_point start = Clock::now();
  for (;;) {
    const std::optional<std::size_t> due = first_due();
    const bool overdue = due && seconds_since(workers_[*due].since) > timeout_s_;
    std::vector<pollfd> channels;
    std::vector<std::size_t> owners;
    for (std::size_t i = 0; i < workers_.size(); ++i)
      if (workers_[i].trial) {
        channels.push_back({workers_[i].channel, POLLIN, 0});
        owners.push_back(i);
      }
    double left = patience_s - seconds_since(start);
    if (left <= 0.0 && !overdue) return std::nullopt;
    if (due) left = std::min(left, std::max(0.0, timeout_s_ - seconds_since(workers_[*due].since)));
    constexpr double ms_per_s = 1000.0;
    const int answers = ::poll(channels.data(), channels.size(), overdue ? 0 : static_cast<int>(ms_per_s * left) + 1);
    // On a busy machine an answer may lie here since before the limit: it counts.
    if (answers <= 0 && overdue) return stop_overdue(*due);
    if (answers <= 0) continue;
    for (std::size_t c = 0; c < channels.size(); ++c)
      if (channels[c].revents != 0)
        if (auto finished = collect(owners[c])) return finished;
  }
}

}  // namespace modebank::app
