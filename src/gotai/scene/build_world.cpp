#include "gotai/scene/build_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/scene/pose_file.h"
#include "gotai/scene/pour.h"
#include "gotai/voxel/shape_cache.h"

namespace gotai::scene {
namespace {

/// Runs `action`; what it refuses becomes an error at a place in the scene.
template <typename Action>
auto located(const Location& where, const Action& action) {
  try {
    return action();
  } catch (const InvalidArgument& error) {
    fail(where, error.what());
  }
}

/// Adds sentences, each behind `prefix`.
void append(std::vector<std::string>& all, const std::vector<std::string>& sentences,
            const std::string& prefix = "") {
  for (const std::string& sentence : sentences) all.push_back(prefix + sentence);
}

void scale_to(geometry::Mesh& mesh, double size) {
  const double extent = geometry::bounding_box(mesh).sizes().maxCoeff();
  for (Vec3& vertex : mesh.vertices) vertex *= size / extent;
}

void add_surroundings(const SceneDescription& scene, World& world) {
  for (const PlaneDescription& plane : scene.planes) world.add_plane(plane);
  for (const ContainerDescription& container : scene.containers) world.add_container(container);
}

void add_bodies(const SceneDescription& scene, World& world) {
  for (const SceneBody& entry : scene.bodies) {
    BodyDescription body = entry.body;
    body.name = entry.name;
    if (entry.poses_path.empty()) {
      located(entry.where, [&] { return world.add_body(body); });
      continue;
    }
    std::size_t number = 0;
    for (const Pose& pose : load_poses(entry.poses_path)) {
      body.name = fmt::format("{} {}", entry.name, ++number);
      body.X_WM = pose;
      located(entry.where, [&] { return world.add_body(body); });
    }
  }
}

void add_pours(const SceneDescription& scene, World& world) {
  if (scene.pours.empty()) return;
  const auto radius = [&world](std::uint32_t shape) {
    return contact_radius(*world.shapes()[shape], world.settings().collision);
  };
  const model::BodyState& bodies = world.bodies();
  double largest = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.is_dynamic(i)) largest = std::max(largest, radius(bodies.shape[i]));
  }
  for (const Pour& pour : scene.pours) {
    for (const std::uint32_t shape : pour.shapes) largest = std::max(largest, radius(shape));
  }
  BallSet occupied(largest);
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.is_dynamic(i)) occupied.add(bodies.x_W[i], radius(bodies.shape[i]));
  }
  for (const Pour& pour : scene.pours) {
    std::size_t number = 0;
    for (const PouredBody& poured : place_pour(pour, world, occupied)) {
      BodyDescription body;
      body.name = fmt::format("{} {}", pour.name, ++number);
      body.shape = poured.shape;
      body.material = pour.material.value_or(scene.shapes[poured.shape].material);
      body.X_WM.q = poured.rotation;
      body.com_position = poured.com_position;
      body.velocity = pour.velocity;
      body.angular_velocity = pour.angular_velocity;
      body.mass = pour.mass;
      body.density = pour.density;
      located(pour.where, [&] { return world.add_body(body); });
    }
  }
}

[[noreturn]] void refuse(const SceneDescription& scene,
                         const std::vector<InitialOverlap>& overlaps) {
  constexpr std::size_t kMostListed = 10;
  std::string text = "bodies overlap at the start by more than one voxel:";
  std::size_t refused = 0;
  for (const InitialOverlap& overlap : overlaps) {
    if (!overlap.is_refused() || ++refused > kMostListed) continue;
    text += fmt::format("\n  {} and {}: {:.4g} m deep, a voxel is {:.4g} m", overlap.body_a,
                        overlap.body_b, overlap.depth, overlap.voxel_edge);
  }
  if (refused > kMostListed) text += fmt::format("\n  and {} more", refused - kMostListed);
  text += "\nMove them apart, or set allow_initial_overlap = true in [world].";
  throw FileError(scene.path, text);
}

}  // namespace

PreparedShape prepare_shape(const ShapeDescription& description, const BuildOptions& options) {
  return located(description.where, [&] {
    PreparedShape prepared;
    geometry::Mesh mesh;
    if (description.mesh_path.empty()) {
      mesh = geometry::generate(description.generator);
    } else {
      geometry::LoadedMesh loaded = geometry::load_mesh(description.mesh_path, description.load);
      mesh = std::move(loaded.mesh);
      prepared.repairs = std::move(loaded.report.repairs);
      prepared.warnings = std::move(loaded.report.warnings);
      if (description.size > 0.0) scale_to(mesh, description.size);
    }
    if (options.progress) options.progress(fmt::format("preparing shape {}", description.name));
    voxel::CachedShape cached =
        voxel::make_shape_cached(description.name, std::move(mesh),
                                 {.prepared_level = description.prepared_level,
                                  .surface_level = description.surface_level,
                                  .accuracy = description.accuracy,
                                  .thickness = description.thickness},
                                 options.cache_folder);
    prepared.shape = std::move(cached.shape);
    append(prepared.warnings, prepared.shape.warnings);
    if (!cached.warning.empty()) prepared.warnings.push_back(std::move(cached.warning));
    return prepared;
  });
}

std::vector<InitialOverlap> find_overlaps(const World& world) {
  const model::BodyState& bodies = world.bodies();
  const auto voxel_edge = [&](model::BodyIndex i) {
    if (bodies.geometry[i] != model::Geometry::shape) return 0.0;
    return world.shapes()[bodies.shape[i]]->pyramid.grid.voxel_edge(
        world.settings().collision.level);
  };
  std::vector<InitialOverlap> overlaps;
  for (const auto& [pair, depth] : world.find_overlaps_now()) {
    overlaps.push_back({world.body_name(pair.body_a), world.body_name(pair.body_b), depth,
                        std::max(voxel_edge(pair.body_a), voxel_edge(pair.body_b))});
  }
  std::stable_sort(overlaps.begin(), overlaps.end(),
                   [](const auto& a, const auto& b) { return a.depth > b.depth; });
  return overlaps;
}

BuiltScene build_world(const SceneDescription& scene, const BuildOptions& options) {
  BuiltScene built;
  built.world = std::make_unique<World>(scene.settings);
  World& world = *built.world;
  world.set_default_material(scene.materials.materials.front());
  for (std::size_t i = 1; i < scene.materials.materials.size(); ++i) {
    world.add_material(scene.materials.materials[i]);
  }
  for (const auto& [pair, surface] : scene.materials.overrides) {
    world.set_material_pair(pair.first, pair.second, surface);
  }
  for (const ShapeDescription& shape : scene.shapes) {
    PreparedShape prepared = prepare_shape(shape, options);
    append(built.repairs, prepared.repairs, "shape " + shape.name + ": ");
    append(built.warnings, prepared.warnings, "shape " + shape.name + ": ");
    const auto shared = std::make_shared<const voxel::Shape>(std::move(prepared.shape));
    located(shape.where, [&] { return world.add_shape(shared); });
  }
  add_surroundings(scene, world);
  add_bodies(scene, world);
  add_pours(scene, world);

  built.overlaps = find_overlaps(world);
  const bool refused = std::any_of(built.overlaps.begin(), built.overlaps.end(),
                                   [](const InitialOverlap& o) { return o.is_refused(); });
  if (refused && options.refuse_overlaps && !scene.allow_initial_overlap) {
    refuse(scene, built.overlaps);
  }
  return built;
}

}  // namespace gotai::scene
