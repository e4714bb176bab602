// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <functional>
#include <future>
#include <string>

namespace posefusion_ros {

/// Runs `task` through `post` (a Worker's), waits for it, and answers a service of `success` and
/// `message` (std_srvs/Trigger) with the sentence it returns or the error it throws. To be called
/// from a queue that no work waits for.
template <typename Response>
void answerTrigger(const std::function<std::future<void>(std::function<void()>)>& post,
                   const std::function<std::string()>& task, Response& response) {
  try {
    std::string message;
    std::exception_ptr failure;
    post([&] {
      try {
        message = task();
      } catch (...) {
        failure = std::current_exception();
      }
    }).get();
    if (failure) std::rethrow_exception(failure);
    response.success = 1;
    response.message = message;
  } catch (const std::future_error&) {
    response.success = 0;
    response.message = "shutting down";
  } catch (const std::exception& error) {
    response.success = 0;
    response.message = error.what();
  }
}

}  // namespace posefusion_ros
