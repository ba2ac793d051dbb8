/// @file
/// Parallel loops with results that do not depend on the number of threads: the body writes only
/// to its own index, and every reduction is done afterwards in index order.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>

#include "gotai/core/thread_team.h"

namespace gotai {

/// Limits the threads that parallel_for uses while it lives. 0 means all processors.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads)
      : control_(tbb::global_control::max_allowed_parallelism,
                 threads > 0 ? static_cast<std::size_t>(threads)
                             : static_cast<std::size_t>(
                                   std::max(1, tbb::this_task_arena::max_concurrency()))) {}

 private:
  tbb::global_control control_;
};

/// Threads that parallel_for may use now.
inline std::size_t thread_count() {
  return std::min(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                  static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency())));
}

/// Calls body(i) for every i in [0, count), by all threads of a team. Each starts with the same
/// part of the indices in every loop of the same size, so that data stay in its cache, and goes on
/// with what others have not begun.
/// @param grain  indices that are taken at once
template <typename Body>
void parallel_for(ThreadTeam& team, std::size_t count, std::size_t grain, const Body& body) {
  struct alignas(64) Part {
    std::atomic<std::size_t> next;
    std::size_t end;
  };
  constexpr std::size_t kMostParts = 64;
  const std::size_t parts = std::min(team.size(), kMostParts);
  std::array<Part, kMostParts> part;
  const std::size_t chunks = (count + grain - 1) / grain;
  for (std::size_t k = 0; k < parts; ++k) {
    part[k].next.store(k * chunks / parts, std::memory_order_relaxed);
    part[k].end = (k + 1) * chunks / parts;
  }
  team.share([&](std::size_t thread) {
    for (std::size_t k = 0; k < parts; ++k) {
      Part& from = part[(thread + k) % parts];
      // Looks before it takes: parts that are finished stay in the caches of all.
      while (from.next.load(std::memory_order_relaxed) < from.end) {
        const std::size_t chunk = from.next.fetch_add(1, std::memory_order_relaxed);
        if (chunk >= from.end) break;
        const std::size_t end = std::min(count, (chunk + 1) * grain);
        for (std::size_t i = chunk * grain; i < end; ++i) body(i);
      }
    }
  });
}

/// Calls body(i) for every i in [0, count), in any order and on any thread.
/// @param grain  smallest number of indices worth a task of its own
template <typename Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  ThreadTeam* const team = ThreadTeam::current();
  if (count <= grain || ThreadTeam::is_working() || (team != nullptr && team->size() == 1)) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  if (team != nullptr) {
    parallel_for(*team, count, grain, body);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&body](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

}  // namespace gotai
