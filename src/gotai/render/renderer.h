/// @file
/// Ray-traced pictures of a run, without any screen: soft shadows, light from the sky, a ground
/// that fades into the distance.
#pragma once

#include <memory>
#include <vector>

#include "gotai/render/picture.h"
#include "gotai/render/stage.h"
#include "gotai/view/run_view.h"

namespace gotai::render {

struct RenderOptions {
  int width = 1280;
  int height = 720;
  int samples = 2;  ///< per pixel and direction: samples^2 rays through a pixel, 1..8
};

/// Draws moments of one run. Meshes are prepared once and shared by all instances.
class Renderer {
 public:
  /// @throws InvalidArgument when the size or the samples are out of range
  Renderer(const view::RunView& run, const RenderOptions& options);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  /// A picture of one moment; rows are drawn in parallel, with the same result for any number of
  /// threads.
  /// @param colours  per body, from body_colours()
  Picture draw(const view::FrameView& frame, const std::vector<Colour>& colours,
               const Camera& camera, const Extent& extent);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gotai::render
