#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace modebank::test {

/// The message of the `Error` that `action` throws. The test fails if `action` throws another exception or none.
template <class Error, class Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& other) {
    ADD_FAILURE() << "another exception: " << other.what();
    return {};
  }
  ADD_FAILURE() << "no exception";
  return {};
}

}  // namespace modebank::test
