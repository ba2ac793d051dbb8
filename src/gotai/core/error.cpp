#include "gotai/core/error.h"

namespace gotai {
namespace {

std::string located(std::string_view path, std::size_t line, std::size_t column,
                    std::string_view reason) {
  std::string text(path);
  if (line > 0) text += ":" + std::to_string(line);
  if (line > 0 && column > 0) text += ":" + std::to_string(column);
  text += ": ";
  text += reason;
  return text;
}

}  // namespace

InvalidArgument::InvalidArgument(std::string_view argument, std::string_view value,
                                 std::string_view reason)
    : Error(std::string(argument) + " = " + std::string(value) + ": " + std::string(reason)) {}

FileError::FileError(std::string_view path, std::string_view reason)
    : Error(located(path, 0, 0, reason)) {}

FileError::FileError(std::string_view path, std::size_t line, std::size_t column,
                     std::string_view reason)
    : Error(located(path, line, column, reason)) {}

}  // namespace gotai
