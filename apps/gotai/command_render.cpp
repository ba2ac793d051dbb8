#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/stopwatch.h"
#include "gotai/render/film.h"
#include "gotai/render/moment.h"
#include "gotai/render/renderer.h"
#include "gotai/view/recorded_run.h"
#include "output_file.h"

namespace gotai::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRenderFooter = R"(Examples:
  gotai render run.h5 -o last.png                          the end of the run
  gotai render run.h5 -o start.png --time 0.5 --size 1920x1080 --samples 4
  gotai render run.h5 -o strip.png --strip 5 --end 2       five moments of the first 2 s side by side
  gotai render run.h5 -o run.mp4 --speed 0.25              a film in slow motion (needs ffmpeg)
  gotai render run.h5 -o frames/                           one picture for each moment of the film
No screen is needed.)";

struct RenderCommand {
  std::string input;
  std::string output;
  std::string size = "1280x720";
  std::string colour;
  std::vector<double> from{0.62, -1.0, 0.5};
  std::optional<double> time;
  std::optional<double> begin;
  std::optional<double> end;
  int strip = 0;
  double fps = 0.0;
  double speed = 1.0;
  double zoom = 1.0;
  int samples = 2;
  int threads = 0;
  bool force = false;

  bool is_single_picture() const { return strip == 0 && output.ends_with(".png"); }
};

std::pair<int, int> parse_size(const std::string& text) {
  int width = 0;
  int height = 0;
  char cross = ' ';
  std::istringstream in(text);
  if (!(in >> width >> cross >> height) || cross != 'x' || !(in >> std::ws).eof())
    throw InvalidArgument("--size", text, "must be WIDTHxHEIGHT, for example 1280x720");
  return {width, height};
}

/// As in the viewer: by material when there are several, else by index.
render::ColourMode default_colours(const view::RunView& run) {
  std::optional<std::uint32_t> first;
  for (const view::BodyView& body : run.bodies) {
    if (body.kind == model::BodyKind::fixed) continue;
    if (first && body.material != *first) return render::ColourMode::material;
    first = body.material;
  }
  return render::ColourMode::index;
}

/// Draws moments of one recording.
class Studio {
 public:
  explicit Studio(const RenderCommand& command)
      : recorded_(view::open_recorded_run(command.input)),
        extent_(render::measure(recorded_.run, recorded_.frames, 24)),
        colours_(command.colour.empty() ? default_colours(recorded_.run)
                                        : render::parse_colour_mode(command.colour)) {
    if (times().empty()) throw FileError(command.input, "has no frame to draw");
    const auto [width, height] = parse_size(command.size);
    options_ = {width, height, command.samples};
    const Vec3 from(command.from[0], command.from[1], command.from[2]);
    if (!(from.norm() > 0.0)) throw InvalidArgument("--from", "0 0 0", "must be a direction");
    frame_what_is_shown(command);
    camera_ =
        render::frame_camera(extent_, from, static_cast<double>(width) / height, command.zoom);
    renderer_ = std::make_unique<render::Renderer>(recorded_.run, options_);
  }

  /// The part of the run that films and strips show [s].
  std::pair<double, double> span(const RenderCommand& command) const {
    const double begin = command.begin.value_or(times().front());
    const double end = command.end.value_or(times().back());
    if (begin > end)
      throw InvalidArgument("--begin", fmt::format("{:g}", begin),
                            fmt::format("must not be after the end, {:g} s", end));
    return {begin, end};
  }
  const std::vector<double>& times() const { return recorded_.frames.times; }
  const render::RenderOptions& options() const { return options_; }

  render::Picture draw(double time) {
    const view::FrameView moment = render::moment_at(recorded_.frames, time);
    return renderer_->draw(moment,
                           render::body_colours(recorded_.run, moment, colours_, extent_.scales),
                           camera_, extent_);
  }

 private:
  /// A single picture frames its own moment; films and strips have one camera for all of theirs.
  /// Colours keep the scales of the whole run.
  void frame_what_is_shown(const RenderCommand& command) {
    constexpr int kMoments = 24;
    const double moment = command.time.value_or(times().back());
    const auto [begin, end] =
        command.is_single_picture() ? std::pair(moment, moment) : span(command);
    std::vector<view::FrameView> shown;
    shown.reserve(kMoments);
    for (int k = 0; k < (begin < end ? kMoments : 1); ++k)
      shown.push_back(
          render::moment_at(recorded_.frames, begin + (end - begin) * k / (kMoments - 1)));
    const render::ColourScales scales = extent_.scales;
    extent_ = render::measure(recorded_.run, shown);
    extent_.scales = scales;
  }

  view::RecordedRun recorded_;
  render::Extent extent_;
  render::ColourMode colours_;
  render::RenderOptions options_;
  render::Camera camera_;
  std::unique_ptr<render::Renderer> renderer_;
};

void draw_picture(Studio& studio, const RenderCommand& command) {
  if (command.strip == 0) {
    render::write_png(command.output, studio.draw(command.time.value_or(studio.times().back())));
    return;
  }
  const auto [first, last] = studio.span(command);
  std::vector<render::Picture> parts;
  parts.reserve(static_cast<std::size_t>(command.strip));
  for (int k = 0; k < command.strip; ++k)
    parts.push_back(studio.draw(first + (last - first) * k / std::max(1, command.strip - 1)));
  render::write_png(command.output, render::side_by_side(parts, studio.options().width / 64));
}

/// Calls use(picture, number) for every picture of the film.
template <typename Use>
std::size_t draw_film(Studio& studio, const RenderCommand& command, double fps, const Use& use) {
  const auto [first, last] = studio.span(command);
  const double length = (last - first) / command.speed;
  const auto count = static_cast<std::size_t>(std::floor(length * fps + 1e-6)) + 1;
  ProgressLine progress;
  const Stopwatch watch;
  for (std::size_t k = 0; k < count; ++k) {
    use(studio.draw(first + static_cast<double>(k) / fps * command.speed), k);
    if (!progress.is_due()) continue;
    const double each = watch.seconds() / static_cast<double>(k + 1);
    progress.show(fmt::format("picture {} of {}, {} left", k + 1, count,
                              format_duration(each * static_cast<double>(count - k - 1))));
  }
  return count;
}

/// The recording's own rate, at most 60 per second.
double film_rate(const Studio& studio, const RenderCommand& command) {
  if (command.fps > 0.0) return command.fps;
  const double span = studio.times().back() - studio.times().front();
  if (!(span > 0.0)) return 30.0;
  return std::clamp(static_cast<double>(studio.times().size() - 1) / span, 1.0, 60.0);
}

std::size_t draw_frames(Studio& studio, const RenderCommand& command, const fs::path& folder,
                        double fps) {
  fs::create_directories(folder);
  return draw_film(studio, command, fps, [&](const render::Picture& picture, std::size_t number) {
    render::write_png((folder / fmt::format("frame_{:05}.png", number)).string(), picture);
  });
}

int render_recording(const RenderCommand& command) {
  const ThreadLimit threads(command.threads);
  const fs::path output(command.output);
  const bool film = output.extension() == ".mp4";
  const bool picture = output.extension() == ".png";
  const bool frames = command.output.ends_with('/') || fs::is_directory(output);
  if (!film && !picture && !frames)
    throw InvalidArgument("--output", command.output,
                          "must end with .png, .mp4, or / for a folder of pictures");
  if (!frames) require_free(command.output, command.force);
  Studio studio(command);
  if (picture) {
    draw_picture(studio, command);
    print(fmt::format("wrote {}\n", command.output));
    return kSuccess;
  }
  const double fps = film_rate(studio, command);
  if (film && render::have_ffmpeg()) {
    render::Film writer(command.output, studio.options().width, studio.options().height, fps);
    const std::size_t count =
        draw_film(studio, command, fps,
                  [&](const render::Picture& drawn, std::size_t) { writer.add(drawn); });
    writer.finish();
    print(fmt::format("wrote {} ({} pictures at {:g} per second)\n", command.output, count, fps));
    return kSuccess;
  }
  fs::path folder = output;
  if (film) folder.replace_extension("");
  const std::size_t count = draw_frames(studio, command, folder, fps);
  print(fmt::format("wrote {} pictures in {}\n", count, folder.string()));
  if (film)
    print_error(
        fmt::format("no film: ffmpeg is not installed. With it: ffmpeg -r {:g} -i "
                    "{}/frame_%05d.png -pix_fmt yuv420p {}",
                    fps, folder.string(), command.output));
  return film ? kInputError : kSuccess;
}

}  // namespace

void add_render_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<RenderCommand>();
  CLI::App* command = app.add_subcommand("render", "Draw pictures or a film of a recording");
  command->footer(kRenderFooter);
  command->add_option("recording", options->input, "Recording to draw")
      ->type_name("RUN.h5")
      ->required();
  command
      ->add_option("-o,--output", options->output,
                   "Picture (.png), film (.mp4) or folder for pictures (name/)")
      ->type_name("OUT")
      ->required();
  command->add_option("--size", options->size, "Pixels")->type_name("WxH")->capture_default_str();
  command->add_option("--time", options->time, "Moment of the picture [s]; by default the end");
  command->add_option("--begin", options->begin, "Begin of a strip or film [s]");
  command->add_option("--end", options->end, "End of a strip or film [s]");
  command->add_option("--strip", options->strip, "This many moments side by side in one picture")
      ->check(CLI::Range(2, 50));
  command->add_option("--fps", options->fps, "Pictures per second of the film")
      ->check(CLI::Range(0.1, 240.0));
  command->add_option("--speed", options->speed, "Speed of the film; 0.5 is half as fast")
      ->check(CLI::Range(0.001, 1000.0))
      ->capture_default_str();
  command->add_option("--from", options->from, "Direction from which the camera looks: X Y Z")
      ->expected(3);
  command->add_option("--zoom", options->zoom, "Nearer (> 1) or farther")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_option("--colour", options->colour,
                      "material, speed, impulse or index; by default as in the viewer");
  command->add_option("--samples", options->samples, "Quality: samples^2 rays per pixel, 1 to 8")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads; 0 means all processors");
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->callback(
      [options, &action] { action = [options] { return render_recording(*options); }; });
}

}  // namespace gotai::cli
