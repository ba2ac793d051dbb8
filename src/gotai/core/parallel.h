/// @file
/// Parallel loops with results that do not depend on the number of threads: the body writes only
/// to its own index, and every reduction is done afterwards in index order.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

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

/// Calls body(i) for every i in [0, count), in any order and on any thread.
/// @param grain  smallest number of indices worth a task of its own
template <typename Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  if (count <= grain) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&body](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

}  // namespace gotai
