/// @file
/// Many short parallel stages, one after the other.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gotai/core/thread_team.h"

namespace gotai {

/// Items [first, first + count) that may be worked on at the same time, by kind of work.
template <typename Kind>
struct Stage {
  Kind kind;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  bool waits = true;  ///< for all items of the stages before; false: it needs what those needed
};

/// One run_stages() by several threads.
///
/// Every item belongs to a thread, the same one in all stages over the same items, so that what it
/// works on stays in that thread's cache. The items of a thread in a stage are its chunk. Chunks
/// are claimed: those of threads that are not there are done by others. The chunks of a thread are
/// done one after the other.
template <typename Kind, typename Work>
class StageRun {
 public:
  static constexpr std::size_t kMostThreads = 16;

  /// @param threads  1 to kMostThreads
  StageRun(std::span<const Stage<Kind>> stages, std::size_t threads, const Work& work)
      : stages_(stages), threads_(threads), work_(work) {}

  /// Does the chunks of a thread, and what others leave undone; returns when all is done.
  void take_part(std::size_t thread) {
    Stops last{};  // for each thread the stage after its last chunk so far
    for (std::uint32_t s = 0; s < stages_.size(); ++s) {
      if (stages_[s].waits && !wait_for_all(last)) return;
      if (has_chunk(thread, s)) {
        Part& own = parts_[thread];
        if (!own.is_here.load(std::memory_order_relaxed))
          own.is_here.store(true, std::memory_order_relaxed);
        if (!wait_for(thread, last[thread])) return;
        const std::uint32_t claimed = own.claimed.load(std::memory_order_relaxed);
        if (claimed <= s) do_chunk(thread, claimed, s);
      }
      for (std::size_t k = 0; k < threads_ && has_chunk(k, s); ++k) last[k] = s + 1;
    }
    wait_for_all(last);
  }

 private:
  using Stops = std::array<std::uint32_t, kMostThreads>;
  /// What a thread is to do. Stages are counted up to and with that of the last chunk claimed,
  /// done.
  struct alignas(64) Claims {
    std::atomic<std::uint32_t> claimed{0};
    std::atomic<bool> is_here{false};
  };
  struct alignas(64) Done {
    std::atomic<std::uint32_t> done{0};
  };
  struct Part : Claims, Done {};

  bool has_chunk(std::size_t thread, std::uint32_t stage) const {
    return thread < stages_[stage].count;
  }

  /// @param claimed  by those who claimed before
  /// @return false if somebody else was faster
  bool do_chunk(std::size_t thread, std::uint32_t claimed, std::uint32_t s) {
    Part& part = parts_[thread];
    if (!part.claimed.compare_exchange_strong(claimed, s + 1, std::memory_order_relaxed))
      return false;
    const Stage<Kind>& stage = stages_[s];
    const auto t = static_cast<std::uint32_t>(thread);
    const auto round = static_cast<std::uint32_t>(2 * threads_);
    try {
      // Items are dealt out to and fro, since they often come by size.
      for (std::uint32_t k = 0; k < stage.count; k += round) {
        if (k + t < stage.count) work_(stage.kind, stage.first + k + t, 1U);
        const std::uint32_t back = k + round - 1 - t;
        if (back < stage.count) work_(stage.kind, stage.first + back, 1U);
      }
    } catch (...) {
      failed_.store(true, std::memory_order_relaxed);
      throw;
    }
    part.done.store(s + 1, std::memory_order_release);
    return true;
  }

  /// @return false if work failed
  bool wait_for_all(const Stops& stages) {
    for (std::size_t k = 0; k < threads_; ++k)
      if (!wait_for(k, stages[k])) return false;
    return true;
  }

  /// Waits until a thread's chunks before a stage are done; does them if it is not there.
  bool wait_for(std::size_t thread, std::uint32_t stage) {
    constexpr std::size_t kPatience =
        300;  // looks, some microseconds: then the system took it away
    Part& part = parts_[thread];
    Patience patience;
    while (part.done.load(std::memory_order_acquire) < stage) {
      if (failed_.load(std::memory_order_relaxed)) return false;
      if (!part.is_here.load(std::memory_order_relaxed) && do_next_chunk(thread, stage)) {
        patience.reset();
      } else if (patience.wait() == kPatience) {
        part.is_here.store(false, std::memory_order_relaxed);
      }
    }
    return true;
  }

  /// The first chunk of a thread that nobody claimed, if there is one before the stage.
  bool do_next_chunk(std::size_t thread, std::uint32_t stage) {
    const std::uint32_t claimed = parts_[thread].claimed.load(std::memory_order_relaxed);
    if (claimed >= stage || parts_[thread].done.load(std::memory_order_acquire) != claimed)
      return false;
    std::uint32_t next = claimed;
    while (!has_chunk(thread, next)) ++next;
    return do_chunk(thread, claimed, next);
  }

  std::array<Part, kMostThreads> parts_;
  std::span<const Stage<Kind>> stages_;
  std::size_t threads_;
  const Work& work_;
  std::atomic<bool> failed_{false};
};

/// Calls work(kind, first, count) for every stage, for parts of it on any thread of the team: an
/// item after all items that its stage waits for.
/// @param least  items per stage, on average, from which on threads are worth their while
/// @throws what work throws
template <typename Kind, typename Work>
void run_stages(const std::vector<Stage<Kind>>& stages, std::size_t least, const Work& work) {
  std::size_t items = 0;
  for (const Stage<Kind>& stage : stages) items += stage.count;
  std::optional<ThreadTeam> own;
  if (ThreadTeam::current() == nullptr && !ThreadTeam::is_working()) own.emplace();
  ThreadTeam* const team = ThreadTeam::current();
  const bool alone = team == nullptr || team->size() == 1 || items < least * stages.size();
  if (alone) {
    for (const Stage<Kind>& stage : stages) work(stage.kind, stage.first, stage.count);
    return;
  }
  const std::size_t threads = std::min(team->size(), StageRun<Kind, Work>::kMostThreads);
  StageRun<Kind, Work> run(stages, threads, work);
  team->share([&](std::size_t thread) {
    if (thread < threads) run.take_part(thread);
  });
}

}  // namespace gotai
