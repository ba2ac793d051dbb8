#include "browser.h"

#include <fmt/format.h>
#include <spawn.h>

#include <array>

#include "console.h"

namespace gotai::cli {

void open_in_browser(const std::string& target) {
#ifdef __APPLE__
  std::string program = "open";
#else
  std::string program = "xdg-open";
#endif
  std::string argument = target;
  std::array<char*, 3> argv{program.data(), argument.data(), nullptr};
  pid_t process = -1;
  if (posix_spawnp(&process, program.c_str(), nullptr, nullptr, argv.data(), environ) != 0)
    print_error(fmt::format("{} was not found; open {} in a browser", program, target));
}

}  // namespace gotai::cli
