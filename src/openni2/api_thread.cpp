// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_openni2/api_thread.hpp"

#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <system_error>
#include <vector>

namespace pf::openni2 {
namespace {

constexpr std::size_t kStackBytes = 2 << 20;

/// Stacks for threads. What it has given out comes back, what it has made stays mapped.
class StackPool {
 public:
  void* take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (free_.empty()) return make();
    void* stack = free_.back();
    free_.pop_back();
    return stack;
  }
  void giveBack(void* stack) {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_.push_back(stack);
  }

 private:
  static void* make() {
    void* stack = mmap(nullptr, kStackBytes, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK | MAP_NORESERVE, -1, 0);
    if (stack == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "a stack");
    // An overflow meets a page without access rights.
    mprotect(stack, static_cast<std::size_t>(sysconf(_SC_PAGESIZE)), PROT_NONE);
    return stack;
  }

  std::mutex mutex_;
  std::vector<void*> free_;
};

/// Never destroyed: OpenNI2 may look at the control blocks until the process ends.
StackPool& stackPool() {
  static StackPool& pool = *new StackPool;
  return pool;
}

}  // namespace

struct ApiThread::Running {
  std::function<void()> work;
  void* stack = nullptr;
  pthread_t thread = {};

  static void* run(void* self) {
    static_cast<Running*>(self)->work();
    return nullptr;
  }
};

ApiThread::ApiThread(std::function<void()> work) : running_(std::make_unique<Running>()) {
  running_->work = std::move(work);
  running_->stack = stackPool().take();
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstack(&attributes, running_->stack, kStackBytes);
  const int error = pthread_create(&running_->thread, &attributes, Running::run, running_.get());
  pthread_attr_destroy(&attributes);
  if (error == 0) return;
  stackPool().giveBack(running_->stack);
  throw std::system_error(error, std::generic_category(), "a thread for OpenNI2");
}

ApiThread::~ApiThread() {
  pthread_join(running_->thread, nullptr);
  stackPool().giveBack(running_->stack);
}

}  // namespace pf::openni2
