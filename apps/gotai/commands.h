/// @file
/// The subcommands: each function registers one with its options and help. Parsing a command line
/// that names it sets `action`, which does the work and returns an ExitCode.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace gotai::cli {

using Action = std::function<int()>;

void add_shape_command(CLI::App& app, Action& action);
void add_check_command(CLI::App& app, Action& action);
void add_run_command(CLI::App& app, Action& action);
void add_compare_command(CLI::App& app, Action& action);
void add_info_command(CLI::App& app, Action& action);
void add_export_command(CLI::App& app, Action& action);
void add_experiment_command(CLI::App& app, Action& action);
void add_view_command(CLI::App& app, Action& action);
void add_render_command(CLI::App& app, Action& action);

}  // namespace gotai::cli
