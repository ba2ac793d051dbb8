#include "gotai/core/thread_team.h"

#include <thread>
#include <utility>

#include "gotai/core/parallel.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace gotai {
namespace {

constexpr std::size_t kSpins = 300;      // looks, about 5 us, before others get the processor
constexpr std::size_t kIdleLooks = 800;  // after which a helper leaves

thread_local ThreadTeam* team_of_thread = nullptr;
thread_local bool thread_works = false;

}  // namespace

std::size_t Patience::wait() {
  if (++waits_ > kSpins) {
    std::this_thread::yield();
  } else {
#if defined(__x86_64__)
    _mm_pause();
#endif
  }
  return waits_;
}

ThreadTeam* ThreadTeam::current() { return team_of_thread; }
bool ThreadTeam::is_working() { return thread_works; }

ThreadTeam::ThreadTeam()
    : helpers_(thread_works ? 0 : thread_count() - 1),
      outer_(team_of_thread),
      is_invited_(std::make_unique<std::atomic<bool>[]>(helpers_)) {
  team_of_thread = this;
}

ThreadTeam::~ThreadTeam() {
  team_of_thread = outer_;
  dismissed_.store(true, std::memory_order_release);
  tasks_.wait();
}

void ThreadTeam::invite_helpers() {
  for (std::size_t k = 0; k < helpers_; ++k) {
    if (is_invited_[k].load(std::memory_order_acquire)) continue;
    is_invited_[k].store(true, std::memory_order_relaxed);
    tasks_.run([this, k] { help(k + 1); });
  }
}

void ThreadTeam::help(std::size_t k) {
  std::uint64_t last = 0;
  Patience patience;
  while (!dismissed_.load(std::memory_order_acquire)) {
    const std::uint64_t number = number_.load(std::memory_order_acquire);
    if (number % 2 == 0 || number == last) {
      if (patience.wait() > kIdleLooks) break;
      continue;
    }
    // Either the owner sees this helper inside and waits for it, or the helper sees that the work
    // is over.
    inside_.fetch_add(1);
    if (number_.load() == number) do_work(k);
    inside_.fetch_sub(1, std::memory_order_release);
    last = number;
    patience.reset();
  }
  is_invited_[k - 1].store(false, std::memory_order_release);
}

void ThreadTeam::do_work(std::size_t k) {
  ThreadTeam* const team = team_of_thread;
  const bool worked = thread_works;
  team_of_thread = nullptr;
  thread_works = true;
  try {
    call_(work_, k);
  } catch (...) {
    if (!failed_.exchange(true)) failure_ = std::current_exception();
  }
  thread_works = worked;
  team_of_thread = team;
}

void ThreadTeam::share_call(Call call, const void* work) {
  call_ = call;
  work_ = work;
  if (helpers_ > 0) invite_helpers();
  number_.fetch_add(1);
  do_work(0);
  number_.fetch_add(1);
  for (Patience patience; inside_.load() != 0;) patience.wait();
  if (!failed_.load(std::memory_order_relaxed)) return;
  failed_.store(false, std::memory_order_relaxed);
  std::rethrow_exception(std::exchange(failure_, nullptr));
}

}  // namespace gotai
