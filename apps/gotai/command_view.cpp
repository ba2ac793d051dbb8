#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "browser.h"
#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/error.h"
#include "gotai/view/pack_run.h"
#include "gotai/view/page.h"
#include "gotai/view/recorded_run.h"
#include "output_file.h"

namespace gotai::cli {
namespace {

constexpr const char* kViewFooter = R"(Examples:
  gotai view run.h5 --open                     writes run.html here and opens it in the browser
  gotai view run.h5 -o run.html --max-mb 10    a smaller page: fewer frames and contacts
The page is one file that holds the run and the viewer. It needs no network and no server: send it
to anybody. What was thinned or rounded stands under "About this run". H shows its keys.)";

struct ViewOptions {
  std::string input;
  std::string output;
  bool open = false;
  bool force = false;
  double max_mb = 30.0;
};

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file)
    throw FileError(path, "cannot be written; is there such a folder, and space on the disk?");
}

int view_recording(ViewOptions options) {
  if (options.output.empty())
    options.output = std::filesystem::path(options.input).stem().string() + ".html";
  require_free(options.output, options.force);
  view::RecordedRun recorded = view::open_recorded_run(options.input);
  recorded.run.generator = "gotai " GOTAI_VERSION;
  view::PackOptions packing;
  packing.page_bytes = static_cast<std::size_t>(options.max_mb * 1e6);
  std::string page;
  {
    ProgressLine progress;
    const auto show = [&](double done) {
      if (progress.is_due()) progress.show(fmt::format("packing frames: {:.0f} %", 100.0 * done));
    };
    page = view::recorded_page(
        view::pack_run(recorded.run, recorded.frames, recorded.steps, packing, show));
  }
  write_text(options.output, page);
  print(fmt::format("wrote {} ({})\n", options.output, format_bytes(page.size())));
  if (options.open) open_in_browser(std::filesystem::absolute(options.output).string());
  return kSuccess;
}

}  // namespace

void add_view_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* command = app.add_subcommand("view", "Make a page to watch a recording in a browser");
  command->footer(kViewFooter);
  command->add_option("recording", options->input, "Recording to show")
      ->type_name("RUN.h5")
      ->required();
  command
      ->add_option("-o,--output", options->output,
                   "Page to write; by default the recording's name with .html, in this folder")
      ->type_name("OUT.html");
  command->add_flag("--open", options->open, "Open the page in the browser");
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_option("--max-mb", options->max_mb, "Size that the page stays below [MB]")
      ->check(CLI::Range(2.0, 2000.0))
      ->capture_default_str();
  command->callback(
      [options, &action] { action = [options] { return view_recording(*options); }; });
}

}  // namespace gotai::cli
