/// @file
/// Which instructions vector code may use.
#pragma once

#include <cstdint>

namespace gotai {

/// The most that vector code may use.
enum class Instructions : std::uint8_t { portable, avx2, best };

/// What the environment asks for: GOTAI_INSTRUCTIONS=portable is code that runs on every processor,
/// =avx2 does without AVX-512, anything else means the best that the processor has. Results are the
/// same bits; that is what it is there to show. Read once.
Instructions wanted_instructions();

}  // namespace gotai
