// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/run.hpp"

#include <tbb/concurrent_queue.h>

#include <atomic>
#include <future>
#include <optional>
#include <utility>

namespace pf {
namespace {

/// Frames that wait between two threads: enough to even out slow frames, few megabytes.
constexpr std::ptrdiff_t kFramesAhead = 2;

/// Items handed from one thread to the next; nothing marks the end.
template <typename Item>
class Handover {
 public:
  Handover() { queue_.set_capacity(kFramesAhead); }

  /// Waits for room.
  void put(std::optional<Item> item) { queue_.push(std::move(item)); }

  /// Waits for an item. Nothing at the end, again and again.
  std::optional<Item> take() {
    std::optional<Item> item;
    if (!ended_) queue_.pop(item);
    ended_ = !item;
    return item;
  }

 private:
  tbb::concurrent_bounded_queue<std::optional<Item>> queue_;
  bool ended_ = false;  ///< of the thread that takes
};

/// Marks the end of what a thread puts, however it leaves its work.
template <typename Item>
struct Ending {
  Handover<Item>& out;
  ~Ending() { out.put(std::nullopt); }
};

/// Takes what is left, so that the producer never waits for ever, and stops the source.
template <typename Item>
struct Draining {
  Handover<Item>& in;
  std::atomic<bool>& stop;
  ~Draining() {
    stop = true;
    while (in.take()) {
    }
  }
};

struct SeenSource {
  SeenFrame seen;
  std::string defect;
};

}  // namespace

Config configFor(Config config, const FrameSource& source) {
  const std::string named = source.sensorKind();
  if (config.sensor.kind == kAnySensor && !named.empty()) config.sensor.kind = named;
  return config;
}

void runPipeline(FrameSource& source, Pipeline& pipeline, const FrameDone& done) {
  if (const auto color = source.colorCamera()) pipeline.registerColor(*color);
  Handover<SourceFrame> read;
  Handover<SeenSource> seen;
  std::atomic<bool> stop{false};

  auto reader = std::async(std::launch::async, [&] {
    const Ending<SourceFrame> ending{read};
    while (!stop) {
      auto frame = source.next();
      if (!frame) return;
      read.put(std::move(frame));
    }
  });
  auto seer = std::async(std::launch::async, [&] {
    const Ending<SeenSource> ending{seen};
    const Draining<SourceFrame> draining{read, stop};
    while (auto frame = read.take()) {
      seen.put(SeenSource{pipeline.see(frame->frame), std::move(frame->defect)});
    }
  });
  {
    const Draining<SeenSource> draining{seen, stop};
    while (auto next = seen.take()) {
      if (!done(pipeline.map(std::move(next->seen)), next->defect)) break;
    }
  }
  reader.get();
  seer.get();
}

}  // namespace pf
