// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/run.hpp"

#include <future>
#include <tuple>
#include <utility>

#include "posefusion/core/bounded_queue.hpp"

namespace pf {
namespace {

/// Frames that wait between two threads: enough to even out slow frames, few megabytes.
constexpr std::size_t kFramesAhead = 4;

struct SeenSource {
  SeenFrame seen;
  std::string defect;
};

/// Closes the queues at the end of a scope, so that no thread waits for another for ever.
template <typename... Queues>
class Closing {
 public:
  explicit Closing(Queues&... queues) : queues_(queues...) {}
  ~Closing() {
    std::apply([](auto&... queue) { (queue.close(), ...); }, queues_);
  }

 private:
  std::tuple<Queues&...> queues_;
};

}  // namespace

void runPipeline(FrameSource& source, Pipeline& pipeline, const FrameDone& done) {
  BoundedQueue<SourceFrame> read(kFramesAhead);
  BoundedQueue<SeenSource> seen(kFramesAhead);

  auto reader = std::async(std::launch::async, [&] {
    const Closing closing(read);
    while (auto frame = source.next()) {
      if (!read.push(std::move(*frame))) return;
    }
  });
  auto seer = std::async(std::launch::async, [&] {
    const Closing closing(read, seen);
    while (auto frame = read.pop()) {
      if (!seen.push({pipeline.see(frame->frame), std::move(frame->defect)})) return;
    }
  });
  {
    const Closing closing(read, seen);
    while (auto next = seen.pop()) {
      if (!done(pipeline.map(std::move(next->seen)), next->defect)) break;
    }
  }
  reader.get();
  seer.get();
}

}  // namespace pf
