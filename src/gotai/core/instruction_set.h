/// @file
/// Which instructions vector code may use.
#pragma once

namespace gotai {

/// Does the environment ask for code that runs on every processor (GOTAI_INSTRUCTIONS=portable)?
/// Results are the same bits; that is what it is there to show. Read once.
bool portable_instructions_wanted();

}  // namespace gotai
