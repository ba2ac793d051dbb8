/// @file
/// What a scene file says, as plain data with every default filled in. Paths are resolved against
/// the folder of the scene file; names are resolved to indices.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"
#include "gotai/model/body_state.h"
#include "gotai/model/material.h"
#include "gotai/model/settings.h"
#include "gotai/scene/document.h"
#include "gotai/world/body_description.h"

namespace gotai::scene {

/// [shapes.NAME]: a mesh file or a generated shape.
struct ShapeDescription {
  std::string name;
  Location where;
  std::string mesh_path;                 ///< "" when generated
  geometry::GeneratorOptions generator;  ///< when mesh_path is ""; its size is applied by it
  geometry::LoadOptions load;            ///< files: unit, up axis, scale
  double size = 0.0;                     ///< files: largest extent after scaling [m]; 0 keeps it
  double thickness = 0.0;                ///< files: makes a solid of a sheet [m]; 0: none
  int prepared_level = 7;                ///< M of the pyramid
  /// Level of the surface model; 0: none. By default the level of [collision] when its model is
  /// "surface".
  int surface_level = 0;
  double accuracy = 0.0;       ///< wish: see voxel::ShapeOptions; 0: the surface level is as given
  std::uint32_t material = 0;  ///< of bodies that name none
};

/// [[bodies]]: one body, or one per line of a pose file.
struct SceneBody {
  std::string name;
  Location where;
  BodyDescription body;    ///< shape and material are indices into the scene's lists
  std::string poses_path;  ///< "" for a single body
};

/// [[pour]]: many bodies at seeded places in a region, none of which touches anything at the start.
struct Pour {
  std::string name;
  Location where;
  std::vector<std::uint32_t> shapes;  ///< one is drawn for each body
  std::uint32_t count = 0;
  Box3 region;                  ///< of the centres of mass [m], W
  bool random_rotation = true;  ///< else `rotation` for all
  Quat rotation = Quat::Identity();
  std::uint64_t seed = 1;
  std::optional<std::uint32_t> material;  ///< else the shape's
  std::optional<double> mass;             ///< [kg]
  std::optional<double> density;          ///< [kg/m^3]
  Vec3 velocity = Vec3::Zero();           ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();   ///< [rad/s]
};

/// [record]
struct RecordSettings {
  double fps = 60.0;         ///< frames per second of simulated time
  bool contacts = true;      ///< contacts of every frame
  double checkpoint = 30.0;  ///< a checkpoint at least every so many seconds of wall time; 0: none
};

/// A whole scene.
struct SceneDescription {
  std::string path;                    ///< of the scene file; "" for text from elsewhere
  std::string text;                    ///< as read, for the recording
  std::vector<std::string> overrides;  ///< "--set" assignments, in the order of application

  double duration = 5.0;               ///< [s]
  bool allow_initial_overlap = false;  ///< overlaps beyond one voxel are accepted
  model::Settings settings;
  model::MaterialTable materials;        ///< index 0 is [material]
  std::vector<ShapeDescription> shapes;  ///< alphabetical by name
  std::vector<PlaneDescription> planes;
  std::vector<ContainerDescription> containers;
  std::vector<SceneBody> bodies;
  std::vector<Pour> pours;
  RecordSettings record;
};

}  // namespace gotai::scene
