/// @file
/// Many short parallel stages, one after the other.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

#include "gotai/core/parallel.h"

namespace gotai::impulse {

/// Items [first, first + count) that may be worked on at the same time, by kind of work.
template <typename Kind>
struct Stage {
  Kind kind;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// Calls work(kind, first, count) for every stage, a stage after all items of those before it.
///
/// Stages of a sweep take microseconds, less than starting a parallel loop. So the threads stay and
/// claim one item after the other from a common counter, those of a stage once all earlier items
/// are done. Helpers that find nothing to do for a while leave; the caller never does.
/// @param least  items per stage, on average, from which on threads are worth their while
template <typename Kind, typename Work>
void run_stages(const std::vector<Stage<Kind>>& stages, std::size_t least, const Work& work) {
  std::size_t items = 0;
  for (const Stage<Kind>& stage : stages) items += stage.count;
  const std::size_t threads = items < least * stages.size() ? 1 : thread_count();
  if (threads == 1) {
    for (const Stage<Kind>& stage : stages) work(stage.kind, stage.first, stage.count);
    return;
  }
  constexpr int kPatience = 4000;  // looks at the counters, about 20 us
  std::atomic<std::size_t> claimed{0};
  std::atomic<std::size_t> done{0};
  parallel_for(threads, 1, [&](std::size_t thread) {
    std::size_t stage = 0;
    std::size_t begin = 0;  // items before this stage
    for (int idle = 0;;) {
      std::size_t next = claimed.load(std::memory_order_relaxed);
      if (next >= items) return;
      while (next >= begin + stages[stage].count) begin += stages[stage++].count;
      if (done.load(std::memory_order_acquire) < begin ||
          !claimed.compare_exchange_weak(next, next + 1, std::memory_order_relaxed)) {
        if (++idle < kPatience) continue;
        if (thread != 0) return;
        std::this_thread::yield();
        continue;
      }
      idle = 0;
      const auto item = static_cast<std::uint32_t>(next - begin);
      work(stages[stage].kind, stages[stage].first + item, 1U);
      done.fetch_add(1, std::memory_order_release);
    }
  });
}

}  // namespace gotai::impulse
