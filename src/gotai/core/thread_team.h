/// @file
/// Threads that stay together through many short pieces of parallel work.
#pragma once

#include <tbb/task_group.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <type_traits>

namespace gotai {

/// While it lives, the loops of the thread that made it (parallel_for, run_stages) are shared with
/// helpers that wait for them awake: handing work over takes a fraction of a microsecond, where
/// waking a thread takes many. Teams are nested like scopes, and a loop inside of shared work runs
/// on its own thread.
///
/// Helpers are oneTBB's threads, as many as it may use. None has to come, and those that come leave
/// when there has been nothing to do for about a tenth of a millisecond, to be called again with
/// the next work: all work has to get done without them.
class ThreadTeam {
 public:
  ThreadTeam();
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  /// Largest number of threads that work is shared by.
  std::size_t size() const { return helpers_ + 1; }

  /// The team of this thread, or null: without one, and inside of shared work.
  static ThreadTeam* current();
  /// Is this thread inside of shared work?
  static bool is_working();

  /// Calls work(0) on this thread and work(k), 0 < k < size(), on every helper that comes while
  /// that lasts; returns when all calls have returned. Not from inside of work.
  /// @throws what a call throws; one of them if several do
  template <typename Work>
  void share(const Work& work) {
    share_call([](const void* w, std::size_t k) { (*static_cast<const Work*>(w))(k); }, &work);
  }

 private:
  using Call = void (*)(const void*, std::size_t);

  void share_call(Call call, const void* work);
  void invite_helpers();
  void help(std::size_t k);
  void do_work(std::size_t k);

  std::size_t helpers_;
  ThreadTeam* outer_;                                // current() before this one
  bool outer_works_;                                 // is_working() before this one
  std::unique_ptr<std::atomic<bool>[]> is_invited_;  // per helper

  // Written by the owner while no helper is inside; odd numbers say that there is work.
  Call call_ = nullptr;
  const void* work_ = nullptr;
  alignas(64) std::atomic<std::uint64_t> number_{0};
  alignas(64) std::atomic<std::size_t> inside_{0};  // helpers that may read call_ and work_
  alignas(64) std::atomic<bool> dismissed_{false};
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;  // written once, by whoever sets failed_
  tbb::task_group tasks_;
};

/// Waits a moment, at first without giving the processor away.
class Patience {
 public:
  /// @return how often it has waited since reset()
  std::size_t wait();
  void reset() { waits_ = 0; }

 private:
  std::size_t waits_ = 0;
};

}  // namespace gotai
