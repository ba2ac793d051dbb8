#include "gotai/scene/pose_file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "gotai/core/error.h"

namespace gotai::scene {
namespace {

constexpr std::string_view kHeader = "px,py,pz,qw,qx,qy,qz";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string without_blanks(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c != ' ' && c != '\t' && c != '\r') out += c;
  }
  return out;
}

double parse_number(std::string_view field, const std::string& path, std::size_t line,
                    std::size_t column) {
  std::string_view digits = trim(field);
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
    throw FileError(path, line, column,
                    fmt::format("\"{}\" is not a finite number", digits.substr(0, 40)));
  }
  return value;
}

Pose parse_pose(std::string_view text, const std::string& path, std::size_t line) {
  std::array<double, 7> n{};
  std::size_t start = 0;
  for (std::size_t i = 0; i < n.size(); ++i) {
    const std::size_t comma = text.find(',', start);
    if ((comma == std::string_view::npos) != (i + 1 == n.size())) {
      throw FileError(path, line, start + 1, fmt::format("a pose needs the 7 numbers {}", kHeader));
    }
    n[i] = parse_number(text.substr(start, comma - start), path, line, start + 1);
    start = comma + 1;
  }
  const Quat q(n[3], n[4], n[5], n[6]);
  const double norm = q.norm();
  if (!(std::abs(norm - 1.0) < 1e-2)) {
    throw FileError(path, line, 1, fmt::format("the quaternion must have length 1, not {}", norm));
  }
  return {Vec3(n[0], n[1], n[2]), q.normalized()};
}

}  // namespace

std::vector<Pose> parse_poses(std::string_view text, const std::string& path) {
  std::vector<Pose> poses;
  bool header_seen = false;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const std::string_view row = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (trim(row).empty() || trim(row).front() == '#') continue;
    if (header_seen) {
      poses.push_back(parse_pose(row, path, line));
    } else if (without_blanks(row) == kHeader) {
      header_seen = true;
    } else {
      throw FileError(path, line, 1,
                      fmt::format("the first line must name the columns: {}", kHeader));
    }
  }
  if (poses.empty()) throw FileError(path, "holds no poses");
  return poses;
}

std::vector<Pose> load_poses(const std::string& path) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{2} << 30;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path, "cannot be read: " + error.message());
  if (size > kLargest) throw FileError(path, "is larger than 2 GiB");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw FileError(path, "cannot be read");
  return parse_poses(std::move(text).str(), path);
}

}  // namespace gotai::scene
