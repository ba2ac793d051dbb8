#include "gotai/scene/suggest.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace gotai::scene {
namespace {

/// Optimal string alignment distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({row[j - 1] + 1, last[j] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string_view nearest_name(std::string_view text, const std::vector<std::string>& names) {
  constexpr std::size_t kLongestName = 64;  // hostile input: the distance is quadratic
  if (text.size() > kLongestName) return {};
  std::string_view best;
  std::size_t best_distance = 1 + std::max<std::size_t>(1, text.size() / 3);
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(text, name);
    if (distance < best_distance) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view text, const std::vector<std::string>& names) {
  constexpr std::size_t kMostNames = 40;
  std::string out;
  const std::string_view nearest = nearest_name(text, names);
  if (!nearest.empty()) out += fmt::format("; did you mean \"{}\"?", nearest);
  const std::vector<std::string> shown(
      names.begin(),
      names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), kMostNames)));
  out += fmt::format("{} Allowed: {}{}", nearest.empty() ? "." : "", fmt::join(shown, ", "),
                     names.size() > kMostNames ? ", .." : "");
  return out;
}

}  // namespace gotai::scene
