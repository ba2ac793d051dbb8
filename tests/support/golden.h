/// @file
/// Access to reference data for tests.
#pragma once

#include <openssl/sha.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "gotai/core/types.h"

namespace gotai::test {

/// Folder with the optional reference data; may not exist.
inline std::filesystem::path shared_dir() { return GOTAI_SHARED_DIR; }
/// Folder with the project's own small test files.
inline std::filesystem::path data_dir() { return GOTAI_TEST_DATA_DIR; }

/// A golden file from tests/data/golden.
inline nlohmann::json golden(const std::string& name) {
  std::ifstream in(data_dir() / "golden" / name);
  if (!in) throw std::runtime_error("missing golden file " + name);
  return nlohmann::json::parse(in);
}

/// A vector, as golden files write it.
inline Vec3 vec(const nlohmann::json& a) {
  return {a[0].get<double>(), a[1].get<double>(), a[2].get<double>()};
}

/// SHA-256 of a text as lower-case hexadecimal digits.
inline std::string sha256(const std::string& text) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest);
  static constexpr char digits[] = "0123456789abcdef";
  std::string hex;
  for (const unsigned char byte : digest) {
    hex += digits[byte >> 4U];
    hex += digits[byte & 15U];
  }
  return hex;
}

}  // namespace gotai::test
