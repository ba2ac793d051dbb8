/// @file
/// What people see: progress on a terminal, tables, numbers with units.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gotai/core/stopwatch.h"

namespace gotai::cli {

/// One line on standard error that is overwritten, at most ten times a second; nothing when
/// standard error is no terminal. The line disappears when the object does.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Is it time for a new line? Ask before making an expensive text.
  bool is_due() const;
  void show(const std::string& text);

 private:
  bool terminal_;
  bool shown_ = false;
  Stopwatch since_last_;
};

/// Rows of "label  value", labels aligned. A row with an empty value is a heading.
class Report {
 public:
  void heading(const std::string& text) { rows_.emplace_back(text, ""); }
  void row(const std::string& label, const std::string& value) { rows_.emplace_back(label, value); }
  std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> rows_;
};

/// Writes to standard output.
void print(const std::string& text);
/// Writes a line to standard error, "gotai: " in front.
void print_error(const std::string& text);

/// "12,345"
std::string format_count(std::uint64_t count);
/// "3.2 MB"
std::string format_bytes(std::uint64_t bytes);
/// "450 ms", "12.3 s", "4 min 05 s", "2 h 10 min"
std::string format_duration(double seconds);
/// Four significant digits and the unit with a metric prefix from micro to kilo: "12.3 mm"
std::string format_length(double metres);

}  // namespace gotai::cli
