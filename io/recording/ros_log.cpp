#include "io/recording/ros_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ident/base/work_counter.hpp"
#include "io/recording/bag.hpp"
#include "io/recording/byte_source.hpp"
#include "io/recording/db3.hpp"
#include "io/recording/log_rows.hpp"
#include "io/recording/mcap.hpp"
#include "io/recording/split_recording.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Opener = std::unique_ptr<Container> (*)(const std::filesystem::path&);

/// The reader for files that begin with these bytes. Null if there is none.
Opener opener_of(std::string_view first_bytes) {
  struct Magic {
    std::string_view bytes;
    Opener open;
  };
  static constexpr std::array<Magic, 3> forms{{{"#ROSBAG V", &open_bag},
                                               {std::string_view{"\x89MCAP", 5}, &open_mcap},
                                               {std::string_view{"SQLite format 3\0", 16}, &open_db3}}};
  for (const Magic& form : forms)
    if (first_bytes.starts_with(form.bytes)) return form.open;
  return nullptr;
}

std::unique_ptr<Container> open_container(const std::filesystem::path& path) {
  constexpr std::uint64_t probed_bytes = 64;
  FileBytes file(path);
  const std::string_view first = file.view(0, std::min(file.size(), probed_bytes));
  if (const Opener open = opener_of(first)) return open(path);
  if (first.starts_with("\x28\xb5\x2f\xfd"))
    throw DataError(fmt::format("{0}: the whole file is compressed; unpack it with `zstd -d {0}`", path.string()));
  throw DataError(fmt::format("{}: not a recording of ROS (.bag, .mcap or .db3)", path.string()));
}

/// The first messages and the last one of each connection.
std::vector<std::vector<std::string>> take_samples(Container& container, std::vector<std::string>& notes) {
  constexpr std::size_t most_samples = 10;  // publishers of one topic may send other names
  std::vector<std::vector<std::string>> samples(container.connections().size());
  std::string failure = container.sample([&](const RecordedMessage& message) {
    auto& own = samples[message.connection];
    if (own.size() == most_samples)
      own.back().assign(message.payload);
    else
      own.emplace_back(message.payload);
  });
  if (!failure.empty()) notes.push_back(std::move(failure));
  return samples;
}

}  // namespace

RosLog::RosLog(const std::filesystem::path& path, const KnownDefinitions& known)
    : RosLog(recording_files(path), known) {}

RosLog::RosLog(std::vector<std::filesystem::path> files, const KnownDefinitions& known) : files_(std::move(files)) {
  for (const std::filesystem::path& file : files_) open_part(file, known);
  const bool any = std::any_of(parts_.begin(), parts_.end(), [](const Part& part) {
    const std::vector<Connection>& all = part.container->connections();
    return std::any_of(all.begin(), all.end(), [](const Connection& connection) { return connection.messages > 0; });
  });
  if (!any)
    throw DataError(
        fmt::format("{}: the recording has no messages{}", files_.front().string(),
                    notes_.empty() ? ": the recording was stopped before the first one" : "; " + notes_.front()));
}

RosLog::~RosLog() = default;

void RosLog::open_part(const std::filesystem::path& path, const KnownDefinitions& known) {
  Part part;
  part.container = open_container(path);
  notes_.insert(notes_.end(), part.container->notes().begin(), part.container->notes().end());
  const auto samples = take_samples(*part.container, notes_);
  for (std::size_t c = 0; c < samples.size(); ++c) {
    const Connection& connection = part.container->connections()[c];
    add_connection(part, connection, choose_decoder(connection, known, samples[c]));
  }
  part.container->close();
  parts_.push_back(std::move(part));
}

void RosLog::add_connection(Part& part, const Connection& connection, TopicDecoder decoder) {
  auto topic =
      std::find_if(topics_.begin(), topics_.end(), [&](const LogTopic& t) { return t.name == connection.topic; });
  if (topic == topics_.end()) {
    LogTopic added{connection.topic, connection.type, {}, 0, {}};
    added.columns.push_back({connection.topic + ".receive_time", MessageColumn::Form::time});
    topic = topics_.insert(topics_.end(), std::move(added));
  } else if (topic->type != connection.type) {
    notes_.push_back(fmt::format("topic {} has messages of {} and of {}; only the first type is read", connection.topic,
                                 topic->type, connection.type));
    part.topic.push_back(no_topic);
    part.decoders.push_back({});
    return;
  }
  topic->messages += connection.messages;
  if (!decoder.schema && topic->problem.empty()) topic->problem = decoder.problem;
  std::vector<MessageColumn> columns;
  for (MessageColumn& column : decoder.columns)
    if (column.path != "receive_time") columns.push_back({topic->name + "." + column.path, column.form});
  merge_columns(topic->columns, columns);
  part.topic.push_back(static_cast<std::size_t>(topic - topics_.begin()));
  part.decoders.push_back(std::move(decoder));
}

std::vector<LogRows> RosLog::read(const std::vector<LogRequest>& requests, std::vector<std::string>& notes,
                                  UsedMessages* used) const {
  std::vector<RowCollector> collectors;
  for (const LogRequest& request : requests) collectors.emplace_back(topics_[request.topic], request);
  struct Route {
    std::size_t collector, reader;
  };
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& part = parts_[p];
    std::vector<bool> wanted(part.topic.size());
    std::vector<std::vector<Route>> routes(part.topic.size());
    for (std::size_t c = 0; c < part.topic.size(); ++c)
      for (std::size_t r = 0; r < requests.size(); ++r)
        if (requests[r].topic == part.topic[c] && part.container->connections()[c].messages > 0) {
          wanted[c] = true;
          routes[c].push_back({r, collectors[r].add_reader(part.decoders[c])});
        }
    const auto topic_of = [&](std::size_t connection) -> const LogTopic& { return topics_[part.topic[connection]]; };
    for (std::size_t c = 0; c < wanted.size(); ++c)
      if (used != nullptr && wanted[c]) used->add_definition(topic_of(c).name, topic_of(c).type, part.decoders[c]);
    const std::string file = files_[p].string();
    std::size_t messages = 0;
    for (std::size_t c = 0; c < wanted.size(); ++c)
      if (wanted[c]) messages += part.container->connections()[c].messages;
    WorkCounter counter("messages of " + files_[p].filename().string(), messages);
    std::string failure = part.container->visit(wanted, [&](const RecordedMessage& message) {
      counter.add();
      if (used != nullptr) used->take(topic_of(message.connection).name, message);
      for (const Route& route : routes[message.connection])
        collectors[route.collector].take(route.reader, message, file);
    });
    part.container->close();
    if (!failure.empty()) notes.push_back(std::move(failure) + "; data before that are read");
  }
  std::vector<LogRows> rows;
  for (RowCollector& collector : collectors) rows.push_back(collector.finish(notes));
  return rows;
}

bool is_ros_log(const std::filesystem::path& path, std::string_view first_bytes) {
  std::error_code error;
  return opener_of(first_bytes) != nullptr || std::filesystem::is_directory(path, error);
}

}  // namespace modebank
