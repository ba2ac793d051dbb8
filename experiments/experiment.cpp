#include "experiment.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "gotai/core/error.h"

namespace gotai::experiments {
namespace {

bool matches(const Record& record, const Json& match) {
  for (const auto& [key, value] : match.items())
    if (!record.contains(key) || record[key] != value) return false;
  return true;
}

}  // namespace

Verdict within(std::string what, double found, double expected, double relative) {
  return {std::move(what), fmt::format("{:.5g} within {:g} %", expected, 100.0 * relative),
          fmt::format("{:.5g}", found),
          std::abs(found - expected) <= relative * std::abs(expected)};
}

Verdict at_most(std::string what, double found, double limit) {
  return {std::move(what), fmt::format("<= {:.4g}", limit), fmt::format("{:.5g}", found),
          found <= limit};
}

Verdict at_least(std::string what, double found, double limit) {
  return {std::move(what), fmt::format(">= {:.4g}", limit), fmt::format("{:.5g}", found),
          found >= limit};
}

Verdict holds(std::string what, bool passed, std::string found) {
  return {std::move(what), "yes", std::move(found), passed};
}

std::vector<Record> select(const std::vector<Record>& records, const Json& match) {
  std::vector<Record> found;
  for (const Record& record : records)
    if (matches(record, match)) found.push_back(record);
  return found;
}

const Record& pick(const std::vector<Record>& records, const Json& match) {
  for (const Record& record : records)
    if (matches(record, match)) return record;
  throw Error("no record matches " + match.dump());
}

}  // namespace gotai::experiments
