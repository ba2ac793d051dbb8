/// @file
/// SceneDescription -> World: prepares the shapes, adds the bodies, pours, checks the start.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gotai/scene/description.h"
#include "gotai/voxel/shape.h"
#include "gotai/world/world.h"

namespace gotai::scene {

/// Two bodies that overlap before the first step.
struct InitialOverlap {
  std::string body_a;
  std::string body_b;
  double depth = 0.0;       ///< deepest overlap of the collision model [m]
  double voxel_edge = 0.0;  ///< edge of the coarser of the two bodies' voxels [m]

  bool is_refused() const { return depth > voxel_edge; }
};

struct BuildOptions {
  /// Folder of prepared shapes; "" prepares anew.
  std::string cache_folder;
  /// Called with a line of text when something long begins. May be empty.
  std::function<void(const std::string&)> progress;
  /// Refuse overlaps beyond one voxel unless the scene allows them. `gotai check` lists them
  /// instead.
  bool refuse_overlaps = true;
};

/// A shape that is ready, and what happened to its mesh on the way, one sentence each.
struct PreparedShape {
  voxel::Shape shape;
  std::vector<std::string> repairs;   ///< what was changed in the mesh
  std::vector<std::string> warnings;  ///< what is odd about the mesh, what was assumed, and why the
                                      ///< cache could not be used
};

/// A world that is ready to step, and what was noticed on the way.
struct BuiltScene {
  std::unique_ptr<World> world;
  std::vector<InitialOverlap> overlaps;  ///< deepest first
  std::vector<std::string> repairs;      ///< of all shapes, as "shape NAME: sentence"
  std::vector<std::string> warnings;     ///< likewise
};

/// @throws FileError naming the place in the scene for shapes that cannot be prepared, bodies that
///         cannot be added, regions too small for their pour, and refused initial overlaps
BuiltScene build_world(const SceneDescription& scene, const BuildOptions& options = {});

/// The shape that a scene asks for, without a world.
PreparedShape prepare_shape(const ShapeDescription& description, const BuildOptions& options = {});

/// Overlaps of a world's present poses, deepest first.
std::vector<InitialOverlap> find_overlaps(const World& world);

}  // namespace gotai::scene
