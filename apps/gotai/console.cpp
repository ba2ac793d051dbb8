#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace gotai::cli {

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

bool ProgressLine::is_due() const { return terminal_ && (!shown_ || since_last_.seconds() > 0.1); }

void ProgressLine::show(const std::string& text) {
  if (!terminal_) return;
  fmt::print(stderr, "\r\x1b[K{}", text);
  std::fflush(stderr);
  shown_ = true;
  since_last_.lap();
}

std::string Report::text() const {
  std::size_t width = 0;
  for (const auto& [label, value] : rows_) {
    if (!value.empty()) width = std::max(width, label.size());
  }
  std::string out;
  for (const auto& [label, value] : rows_) {
    out += value.empty() ? label + "\n" : fmt::format("  {:<{}}  {}\n", label, width, value);
  }
  return out;
}

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

void print_error(const std::string& text) { fmt::print(stderr, "gotai: {}\n", text); }

std::string format_count(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (auto i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3) {
    digits.insert(static_cast<std::size_t>(i), ",");
  }
  return digits;
}

std::string format_bytes(std::uint64_t bytes) {
  static constexpr const char* units[] = {"B", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1000.0 && unit + 1 < std::size(units)) {
    value /= 1000.0;
    ++unit;
  }
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.3g} {}", value, units[unit]);
}

std::string format_duration(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.3g} us", 1e6 * seconds);
  if (seconds < 1.0) return fmt::format("{:.3g} ms", 1e3 * seconds);
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string format_length(double metres) {
  const double size = std::abs(metres);
  if (size == 0.0) return "0 m";
  if (size < 1e-3) return fmt::format("{:.4g} um", 1e6 * metres);
  if (size < 1.0) return fmt::format("{:.4g} mm", 1e3 * metres);
  if (size < 1e3) return fmt::format("{:.4g} m", metres);
  return fmt::format("{:.4g} km", 1e-3 * metres);
}

}  // namespace gotai::cli
