/// @file
/// The exceptions of the library. Every message says what is wrong, with which value, and what to
/// do.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace gotai {

/// Base of everything that the library throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An argument or setting has an impossible value.
class InvalidArgument : public Error {
 public:
  /// @param argument  its name, as the user writes it ("material.friction")
  /// @param value     the offending value as text
  /// @param reason    what is allowed ("must be >= 0")
  InvalidArgument(std::string_view argument, std::string_view value, std::string_view reason);
};

/// A file cannot be read, written or understood. The message starts with "path:line:column: ".
class FileError : public Error {
 public:
  FileError(std::string_view path, std::string_view reason);
  /// @param line    1-based; 0 when it does not apply
  /// @param column  1-based; 0 when it does not apply
  FileError(std::string_view path, std::size_t line, std::size_t column, std::string_view reason);
};

/// The simulation cannot go on: a state became non-finite or the energy ran away.
class SimulationError : public Error {
 public:
  using Error::Error;
};

}  // namespace gotai
