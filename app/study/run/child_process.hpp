#pragma once

#include <sys/types.h>

#include <functional>
#include <string>

namespace modebank::app {

/// Forks a process that ends with this one, however this one ends; 0 in the child. Throws DataError when it cannot be
/// started.
pid_t fork_child();

/// The result of `work`, computed in a process of its own, so that this one gets none of the threads that it starts.
/// Errors of `work` are thrown here. Throws DataError when the process cannot be started or ends without an answer.
std::string in_own_process(const std::function<std::string()>& work);

/// The end of a process by its status, as words: "its process was ended by signal 9 (Killed)".
std::string how_it_ended(int status);

}  // namespace modebank::app
