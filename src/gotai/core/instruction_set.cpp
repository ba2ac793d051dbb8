#include "gotai/core/instruction_set.h"

#include <cstdlib>
#include <string_view>

namespace gotai {

Instructions wanted_instructions() {
  static const Instructions wanted = [] {
    const char* name = std::getenv("GOTAI_INSTRUCTIONS");
    if (name == nullptr) return Instructions::best;
    if (std::string_view(name) == "portable") return Instructions::portable;
    if (std::string_view(name) == "avx2") return Instructions::avx2;
    return Instructions::best;
  }();
  return wanted;
}

}  // namespace gotai
