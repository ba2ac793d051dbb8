/// @file
/// Stands in for TBB's task_group in builds with the thread sanitizer, as parallel_for.h does for
/// its loops.
#pragma once

#include <thread>
#include <utility>
#include <vector>

namespace tbb {

/// Runs every task on a thread of its own.
class task_group {
 public:
  template <typename Task>
  void run(Task task) {
    threads_.emplace_back(std::move(task));
  }
  /// Returns when all tasks have ended.
  void wait() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::vector<std::thread> threads_;
};

}  // namespace tbb
