#include <fmt/format.h>

#include <cmath>

#include "gotai/scene/readers.h"
#include "gotai/scene/suggest.h"

namespace gotai::scene::detail {
namespace {

constexpr double kPi = 3.14159265358979323846;

Vec3 read_direction(const Node& node, std::string_view name) {
  const Vec3 direction = read_vector(node, name);
  if (!(direction.norm() > 0.0)) fail(node.where, fmt::format("{} must not be zero", name));
  return direction.stableNormalized();
}

model::BodyKind read_kind(TableReader& table) {
  static const std::vector<std::string> names = {"dynamic", "fixed", "kinematic"};
  const Node* node = table.find("kind");
  if (node == nullptr) return model::BodyKind::dynamic;
  const std::string& text = read_text(*node, "kind");
  if (text == "dynamic") return model::BodyKind::dynamic;
  if (text == "fixed") return model::BodyKind::fixed;
  if (text == "kinematic") return model::BodyKind::kinematic;
  fail(node->where, fmt::format("kind = \"{}\" is not known{}", text, suggestion(text, names)));
}

/// Where the body is; key frames say it for kinematic ones, a file for many.
void read_pose(TableReader& table, SceneDescription& scene, SceneBody& out) {
  const Node* position = table.find("position");
  const Node* com_position = table.find("com_position");
  const Node* rotation = table.find("rotation");
  if (const Node* poses = table.find("poses")) {
    for (const Node* other : {position, com_position, rotation}) {
      if (other != nullptr)
        fail(other->where, "poses = \"file\" already says where the bodies are");
    }
    out.poses_path = resolve(scene, read_text(*poses, "poses"));
    return;
  }
  if (position != nullptr && com_position != nullptr) {
    fail(com_position->where, "give either position or com_position");
  }
  if (position != nullptr) out.body.X_WM.p = read_vector(*position, "position");
  if (com_position != nullptr) {
    out.body.com_position = read_vector(*com_position, "com_position");
  }
  if (rotation != nullptr) out.body.X_WM.q = read_rotation(*rotation);
}

void read_motion(TableReader& table, SceneBody& out) {
  const bool kinematic = out.body.kind == model::BodyKind::kinematic;
  const Node* frames = table.find("key_frames");
  if (kinematic != (frames != nullptr)) {
    fail(frames != nullptr ? frames->where : table.where(),
         kinematic ? "a kinematic body needs [[bodies.key_frames]] with time, position, rotation"
                   : "only kinematic bodies have key frames");
  }
  if (frames == nullptr) return;
  for (const char* key : {"position", "com_position", "rotation", "poses"}) {
    const Node* node = table.find(key);
    if (node != nullptr) fail(node->where, "the key frames already say where the body is");
  }
  for (const Node& node : read_array(*frames, "bodies.key_frames")) {
    TableReader frame(node, "[[bodies.key_frames]]");
    KeyFrame key;
    key.time = read_number(frame.require("time"), "time", range::any);
    key.X_WM.p = read_vector(frame.require("position"), "position");
    if (const Node* rotation = frame.find("rotation")) key.X_WM.q = read_rotation(*rotation);
    frame.finish();
    if (!out.body.motion.empty() && !(key.time > out.body.motion.back().time)) {
      fail(node.where, fmt::format("key frames must ascend in time; {} s comes after {} s",
                                   key.time, out.body.motion.back().time));
    }
    out.body.motion.push_back(key);
  }
  if (out.body.motion.empty()) fail(frames->where, "a kinematic body needs at least one key frame");
  out.body.X_WM = out.body.motion.front().X_WM;
}

void read_velocities(TableReader& table, BodyDescription& body) {
  for (const char* key : {"velocity", "angular_velocity"}) {
    const Node* node = table.find(key);
    if (node != nullptr && body.kind != model::BodyKind::dynamic) {
      fail(node->where, fmt::format("only dynamic bodies have an initial {}", key));
    }
  }
  body.velocity = table.vector("velocity", body.velocity);
  body.angular_velocity = table.vector("angular_velocity", body.angular_velocity);
}

SceneBody read_body(const Node& node, std::size_t number, SceneDescription& scene) {
  SceneBody out;
  out.where = node.where;
  TableReader table(node, "[[bodies]]");
  out.name = table.text("name", "");
  out.body.shape = read_shape_name(table.require("shape"), scene);
  if (out.name.empty()) {
    out.name = fmt::format("{} {}", scene.shapes[out.body.shape].name, number + 1);
  }
  out.body.kind = read_kind(table);
  out.body.material = read_material(table, scene).value_or(scene.shapes[out.body.shape].material);
  read_pose(table, scene, out);
  read_motion(table, out);
  read_velocities(table, out.body);
  read_mass(table, out.body.mass, out.body.density);
  table.finish();
  return out;
}

Pour read_pour(const Node& node, std::size_t number, SceneDescription& scene) {
  Pour pour;
  pour.where = node.where;
  TableReader table(node, "[[pour]]");
  pour.name = table.text("name", fmt::format("pour {}", number + 1));
  const Node& shape = table.require("shape");
  if (const Node::Array* several = shape.array()) {
    for (const Node& element : *several) pour.shapes.push_back(read_shape_name(element, scene));
    if (pour.shapes.empty()) fail(shape.where, "shape must name at least one shape");
  } else {
    pour.shapes.push_back(read_shape_name(shape, scene));
  }
  pour.count =
      static_cast<std::uint32_t>(read_integer(table.require("count"), "count", 1, 10'000'000));
  TableReader region(table.require("region"), "the region of [[pour]]");
  const Vec3 low = read_vector(region.require("min"), "min");
  const Vec3 high = read_vector(region.require("max"), "max");
  region.finish();
  if (!((high - low).minCoeff() >= 0.0)) {
    fail(region.where(), "the region's min must not exceed its max in any direction");
  }
  pour.region = Box3(low, high);
  if (const Node* rotation = table.find("rotation")) {
    const auto* text = std::get_if<std::string>(&rotation->value);
    if (text == nullptr) {
      pour.rotation = read_rotation(*rotation);
    } else if (*text != "random") {
      fail(rotation->where,
           fmt::format("rotation = \"{}\" must be \"random\" or a rotation", *text));
    }
    pour.random_rotation = text != nullptr;
  }
  pour.seed = static_cast<std::uint64_t>(table.integer("seed", 1, 0, INT64_MAX));
  pour.material = read_material(table, scene);
  read_mass(table, pour.mass, pour.density);
  pour.velocity = table.vector("velocity", pour.velocity);
  pour.angular_velocity = table.vector("angular_velocity", pour.angular_velocity);
  table.finish();
  return pour;
}

}  // namespace

Quat read_rotation(const Node& node) {
  TableReader table(node, "a rotation");
  const Node* axis = table.find("axis");
  const Node* degrees = table.find("degrees");
  const Node* quaternion = table.find("quaternion");
  table.finish();
  if (quaternion != nullptr && axis == nullptr && degrees == nullptr) {
    const std::vector<double> n = read_numbers(*quaternion, "quaternion", 4);
    const Quat q(n[0], n[1], n[2], n[3]);
    const double norm = q.norm();
    if (!(std::abs(norm - 1.0) < 1e-3)) {
      fail(quaternion->where,
           fmt::format("quaternion = [w, x, y, z] must have length 1, not {}", norm));
    }
    return q.normalized();
  }
  if (axis == nullptr || degrees == nullptr || quaternion != nullptr) {
    fail(node.where,
         "write a rotation as { axis = [x, y, z], degrees = a } or { quaternion = [w, x, y, z] }");
  }
  const double angle = read_number(*degrees, "degrees", range::any) * (kPi / 180.0);
  return Quat(Eigen::AngleAxisd(angle, read_direction(*axis, "axis")));
}

void read_mass(TableReader& table, std::optional<double>& mass, std::optional<double>& density) {
  mass = table.optional_number("mass", range::positive);
  density = table.optional_number("density", range::positive);
  if (mass && density) fail(table.find("density")->where, "give either mass or density");
}

void read_surroundings(TableReader& document, SceneDescription& scene) {
  for_each_table(document, "plane", [&](const Node& node, std::size_t number) {
    TableReader table(node, "[[plane]]");
    PlaneDescription plane;
    plane.name = table.text("name", fmt::format("plane {}", number + 1));
    plane.point = table.vector("point", plane.point);
    if (const Node* normal = table.find("normal")) plane.normal = read_direction(*normal, "normal");
    plane.material = read_material(table, scene).value_or(0);
    table.finish();
    scene.planes.push_back(plane);
  });
  for_each_table(document, "container", [&](const Node& node, std::size_t number) {
    TableReader table(node, "[[container]]");
    ContainerDescription container;
    container.name = table.text("name", fmt::format("container {}", number + 1));
    const Node& inner = table.require("inner");
    container.inner = read_vector(inner, "inner");
    if (!(container.inner.minCoeff() > 0.0)) {
      fail(inner.where, "inner = [x, y, height] must be > 0 in every direction");
    }
    container.floor_center = table.vector("floor_center", container.floor_center);
    container.material = read_material(table, scene).value_or(0);
    table.finish();
    scene.containers.push_back(container);
  });
}

void read_bodies(TableReader& document, SceneDescription& scene) {
  for_each_table(document, "bodies", [&](const Node& node, std::size_t number) {
    scene.bodies.push_back(read_body(node, number, scene));
  });
}

void read_pours(TableReader& document, SceneDescription& scene) {
  for_each_table(document, "pour", [&](const Node& node, std::size_t number) {
    scene.pours.push_back(read_pour(node, number, scene));
  });
}

}  // namespace gotai::scene::detail
