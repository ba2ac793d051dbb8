// gotai: the command line program.
#include <exception>
#include <new>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/error.h"

namespace gotai::cli {
namespace {

constexpr const char* kFooter = R"(Start here:
  gotai check examples/hexapods.toml                    is the scene right, and what will it cost?
  gotai run examples/hexapods.toml -o hexapods.h5       simulate and record
  gotai view hexapods.h5 --open                         watch it in the browser
  gotai info hexapods.h5                                what is in the recording
  gotai export hexapods.h5 -o hexapods.glb              an animation for Blender and other tools
  gotai experiment fall                                 a figure of the thesis, with what must come out
`gotai COMMAND --help` explains each command with examples.

Exit codes: 0 done · 1 bad input, or a file cannot be written · 2 wrong command line ·
3 the simulation failed (recorded frames are kept) · 4 an experiment did not come out as expected ·
130 interrupted (recorded frames are kept))";

int run_action(const Action& action) {
  try {
    return action();
  } catch (const SimulationError& error) {
    print_error(error.what());
    return kSimulationFailed;
  } catch (const Error& error) {
    print_error(error.what());
    return kInputError;
  } catch (const std::bad_alloc&) {
    print_error("out of memory; use a coarser level or fewer bodies");
    return kInputError;
  }
}

int run(int argc, char** argv) {
  CLI::App app("Gotai simulates rigid bodies of any shape, straight from the mesh.", "gotai");
  app.set_version_flag("--version", "gotai " GOTAI_VERSION);
  app.footer(kFooter);
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::simple);

  Action action;
  add_shape_command(app, action);
  add_check_command(app, action);
  add_run_command(app, action);
  add_compare_command(app, action);
  add_info_command(app, action);
  add_view_command(app, action);
  add_render_command(app, action);
  add_export_command(app, action);
  add_experiment_command(app, action);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kSuccess : kUsageError;
  }
  return run_action(action);
}

}  // namespace
}  // namespace gotai::cli

int main(int argc, char** argv) {
  try {
    return gotai::cli::run(argc, argv);
  } catch (const std::exception& error) {
    gotai::cli::print_error(error.what());
    return gotai::cli::kInputError;
  }
}
