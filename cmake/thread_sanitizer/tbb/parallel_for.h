/// @file
/// Stands in for TBB's parallel_for in builds with the thread sanitizer. The library itself is not
/// instrumented, so the sanitizer cannot see how it orders its tasks and takes every loop for a
/// race; here loops run on plain threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace tbb {

/// Calls body(part of range) on as many threads as TBB may use, at least two and at most four.
template <typename Index, typename Body>
void parallel_for(const blocked_range<Index>& range, const Body& body) {
  const std::size_t allowed = global_control::active_value(global_control::max_allowed_parallelism);
  const std::size_t threads = allowed == 1 ? 1 : std::clamp<std::size_t>(allowed, 2, 4);
  const std::size_t parts = std::clamp<std::size_t>(range.size() / range.grainsize(), 1, threads);
  std::vector<std::exception_ptr> errors(parts);
  const auto run = [&](std::size_t part) {
    try {
      body(blocked_range<Index>(range.begin() + range.size() * part / parts,
                                range.begin() + range.size() * (part + 1) / parts,
                                range.grainsize()));
    } catch (...) {
      errors[part] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (std::size_t part = 1; part < parts; ++part) others.emplace_back(run, part);
  run(0);
  for (std::thread& thread : others) thread.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace tbb
