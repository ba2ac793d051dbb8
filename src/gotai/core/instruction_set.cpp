#include "gotai/core/instruction_set.h"

#include <cstdlib>
#include <string_view>

namespace gotai {

bool portable_instructions_wanted() {
  static const bool wanted = [] {
    const char* instructions = std::getenv("GOTAI_INSTRUCTIONS");
    return instructions != nullptr && std::string_view(instructions) == "portable";
  }();
  return wanted;
}

}  // namespace gotai
