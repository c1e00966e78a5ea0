#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "io/recording/ros_log.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/import/expect_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::test {

inline constexpr const char* python = "/usr/bin/python3";

/// Runs recordings.py. The test fails if the script fails.
inline void run_recordings_script(std::vector<std::string> arguments) {
  const std::string script = (project_dir() / "tests" / "io" / "recording" / "recordings.py").string();
  arguments.insert(arguments.begin(), {python, "-B", script});
  const ProgramResult result = run_program(arguments);
  ASSERT_EQ(result.status, 0) << result.err;
}

#define MODEBANK_NEEDS_ROSBAG()                                         \
  MODEBANK_NEEDS(::modebank::test::has_python_modules("rosbag, genpy"), \
                 "rosbag is absent: apt-get install python3-rosbag")

inline std::size_t topic_position(const RosLog& log, const std::string& name) {
  for (std::size_t t = 0; t < log.topics().size(); ++t)
    if (log.topics()[t].name == name) return t;
  ADD_FAILURE() << "no topic " << name;
  return 0;
}

/// All columns of one topic. Each column is requested in its own form.
struct WholeTopic {
  LogTopic topic;
  LogRows rows;

  const LogColumn& column(const std::string& field) const {
    for (std::size_t i = 0; i < topic.columns.size(); ++i)
      if (topic.columns[i].path == topic.name + "." + field) return rows.columns[i];
    throw std::runtime_error(topic.name + " has no " + field);
  }
};

inline WholeTopic read_topic(const RosLog& log, const std::string& name) {
  const LogTopic& topic = log.topics()[topic_position(log, name)];
  LogRequest request{topic_position(log, name), {}};
  for (const MessageColumn& column : topic.columns)
    request.columns.push_back({column.path, column.form == MessageColumn::Form::text   ? LogWant::Form::text
                                            : column.form == MessageColumn::Form::time ? LogWant::Form::exact
                                                                                       : LogWant::Form::number});
  std::vector<std::string> notes;
  return {topic, log.read({request}, notes).front()};
}

inline LogColumn read_column(const RosLog& log, const std::string& topic, const std::string& column,
                             LogWant::Form form = LogWant::Form::number) {
  std::vector<std::string> notes;
  return log.read({{topic_position(log, topic), {{column, form}}}}, notes).front().columns.front();
}

/// Expects the same numbers, including NaN and the signs of zeros.
inline void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t k = 0; k < a.size(); ++k)
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a[k]), std::bit_cast<std::uint64_t>(b[k]))
        << what << ", row " << k << ": " << a[k] << " and " << b[k];
}

/// Expects that `b` has every column of `a`, with the same values in the same rows.
inline void expect_same_topic(const WholeTopic& a, const WholeTopic& b) {
  ASSERT_EQ(a.rows.message.size(), b.rows.message.size()) << a.topic.name;
  ASSERT_EQ(a.topic.columns.size(), b.topic.columns.size()) << a.topic.name;
  for (std::size_t i = 0; i < a.topic.columns.size(); ++i) {
    const std::string& name = a.topic.columns[i].path;
    ASSERT_EQ(name, b.topic.columns[i].path);
    expect_same_bits(a.rows.columns[i].numbers, b.rows.columns[i].numbers, name);
    EXPECT_EQ(a.rows.columns[i].text, b.rows.columns[i].text) << name;
    EXPECT_EQ(a.rows.columns[i].exact, b.rows.columns[i].exact) << name;
  }
}

}  // namespace modebank::test
