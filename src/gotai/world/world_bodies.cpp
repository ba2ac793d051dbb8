// Building a world, reading and changing its bodies.
#include <algorithm>
#include <string>

#include "gotai/core/error.h"
#include "gotai/world/world.h"

namespace gotai {
namespace {

void require_finite(const Vec3& value, const char* name) {
  if (!value.allFinite()) throw InvalidArgument(name, "not a number", "must be finite");
}

Quat unit(const Quat& q) {
  const double norm = q.norm();
  if (!(norm > 0.0) || !std::isfinite(norm))
    throw InvalidArgument("rotation", "norm " + std::to_string(norm), "must be a rotation");
  return Quat(q.coeffs() / norm);
}

}  // namespace

ShapeId World::add_shape(std::shared_ptr<const voxel::Shape> shape) {
  if (shape->pyramid.max_level() < settings_.collision.level)
    throw InvalidArgument("collision.level", std::to_string(settings_.collision.level),
                          "shape '" + shape->name + "' is prepared only to level " +
                              std::to_string(shape->pyramid.max_level()) +
                              "; prepare it finer or choose a coarser level");
  shapes_.push_back(std::move(shape));
  return static_cast<ShapeId>(shapes_.size() - 1);
}

MaterialId World::add_material(const model::Material& material) {
  materials_.materials.push_back(material);
  model::validate(materials_);
  return static_cast<MaterialId>(materials_.materials.size() - 1);
}

void World::set_default_material(const model::Material& material) {
  materials_.materials.front() = material;
  model::validate(materials_);
}

void World::set_material_pair(MaterialId a, MaterialId b, const model::SurfacePair& pair) {
  materials_.overrides[std::minmax(a, b)] = pair;
  model::validate(materials_);
}

BodyId World::append(const std::string& name) {
  const BodyId id{next_id_++};
  model::append_body(bodies_);
  ids_.push_back(id);
  names_.push_back(name.empty() ? "body " + std::to_string(id.value) : name);
  loads_.force.emplace_back(Vec3::Zero());
  loads_.torque.emplace_back(Vec3::Zero());
  return id;
}

BodyId World::add_body(const BodyDescription& d) {
  if (d.shape >= shapes_.size())
    throw InvalidArgument("body.shape", std::to_string(d.shape), "no such shape");
  if (d.material >= materials_.materials.size())
    throw InvalidArgument("body.material", std::to_string(d.material), "no such material");
  if (!d.motion.empty() && d.kind != model::BodyKind::kinematic)
    throw InvalidArgument("body.motion", d.name, "only kinematic bodies have key frames");
  for (std::size_t k = 1; k < d.motion.size(); ++k)
    if (!(d.motion[k].time > d.motion[k - 1].time))
      throw InvalidArgument("body.motion", std::to_string(d.motion[k].time), "times must ascend");
  require_finite(d.X_WM.p, "body.position");
  require_finite(d.velocity, "body.velocity");
  require_finite(d.angular_velocity, "body.angular_velocity");
  const voxel::Shape& shape = *shapes_[d.shape];
  const double density = d.density.value_or(materials_.materials[d.material].density);
  const double mass = d.mass.value_or(density * shape.mass.volume);
  if (!(mass > 0.0) || !std::isfinite(mass))
    throw InvalidArgument("body.mass", std::to_string(mass), "must be positive and finite [kg]");
  const Quat q_WB = unit(d.X_WM.q);

  const BodyId id = append(d.name);
  const auto i = static_cast<model::BodyIndex>(bodies_.size() - 1);
  const int level = settings_.collision.level;
  bodies_.kind[i] = d.kind;
  bodies_.geometry[i] = model::Geometry::shape;
  bodies_.shape[i] = d.shape;
  bodies_.material[i] = d.material;
  bodies_.p_MB[i] = shape.mass.center_of_mass;
  bodies_.bounding_radius[i] =
      settings_.collision.model == model::CollisionModel::spheres
          ? shape.voxel_bounding_radius[static_cast<std::size_t>(level) - 1]
          : shape.bounding_radius;
  bodies_.voxel_radius[i] = shape.pyramid.grid.voxel_radius(level);
  const Pose X_WM = d.motion.empty() ? Pose{d.X_WM.p, q_WB} : d.motion.front().X_WM;
  place(i, X_WM);
  if (d.com_position && d.motion.empty()) bodies_.x_W[i] = *d.com_position;
  if (d.kind == model::BodyKind::dynamic)
    model::set_mass(bodies_, i, mass, (mass / shape.mass.volume) * shape.mass.inertia);
  if (!d.motion.empty()) motions_[id] = d.motion;
  if (d.kind != model::BodyKind::fixed) set_velocity(id, d.velocity, d.angular_velocity);
  return id;
}

BodyId World::add_plane(const PlaneDescription& d) {
  require_finite(d.point, "plane.point");
  require_finite(d.normal, "plane.normal");
  if (!(d.normal.norm() > 0.0))
    throw InvalidArgument("plane.normal", "[0, 0, 0]", "must have a direction");
  const BodyId id = append(d.name.empty() ? "plane " + std::to_string(next_id_) : d.name);
  const auto i = static_cast<model::BodyIndex>(bodies_.size() - 1);
  bodies_.geometry[i] = model::Geometry::plane;
  bodies_.material[i] = d.material;
  bodies_.x_W[i] = d.point;
  bodies_.q_WB[i] = Quat::FromTwoVectors(Vec3::UnitZ(), d.normal.normalized()).normalized();
  return id;
}

BodyId World::add_container(const ContainerDescription& d) {
  require_finite(d.floor_center, "container.floor_center");
  require_finite(d.inner, "container.inner");
  if (!(d.inner.minCoeff() > 0.0))
    throw InvalidArgument("container.inner", std::to_string(d.inner.minCoeff()),
                          "inner edges must be positive [m]");
  const BodyId id = append(d.name.empty() ? "container " + std::to_string(next_id_) : d.name);
  const auto i = static_cast<model::BodyIndex>(bodies_.size() - 1);
  bodies_.geometry[i] = model::Geometry::container;
  bodies_.material[i] = d.material;
  bodies_.x_W[i] = d.floor_center;
  bodies_.half_extent[i] = Vec3(0.5 * d.inner.x(), 0.5 * d.inner.y(), d.inner.z());
  return id;
}

void World::remove_body(BodyId id) {
  const model::BodyIndex removed = index(id);
  model::erase_body(bodies_, removed);
  const auto at = static_cast<std::ptrdiff_t>(removed);
  ids_.erase(ids_.begin() + at);
  names_.erase(names_.begin() + at);
  loads_.force.erase(loads_.force.begin() + at);
  loads_.torque.erase(loads_.torque.begin() + at);
  motions_.erase(id);
  // Contacts name columns: those of the removed body go, later columns move up.
  std::erase_if(memory_.entries, [removed](const model::ContactMemory::Entry& e) {
    return e.body_a == removed || e.body_b == removed;
  });
  for (model::ContactMemory::Entry& e : memory_.entries) {
    if (e.body_a > removed) --e.body_a;
    if (e.body_b > removed) --e.body_b;
  }
  model::erase_body(anchors_, removed);
  contacts_.clear();
  update_.reset(bodies_.size(), 0);
}

model::BodyIndex World::index(BodyId id) const {
  const auto it = std::lower_bound(ids_.begin(), ids_.end(), id);
  if (it == ids_.end() || *it != id)
    throw InvalidArgument("body id", std::to_string(id.value), "no such body (was it removed?)");
  return static_cast<model::BodyIndex>(it - ids_.begin());
}

void World::place(model::BodyIndex i, const Pose& X_WM) {
  const Vec3 w_W = bodies_.w_W[i];
  bodies_.q_WB[i] = unit(X_WM.q);
  bodies_.x_W[i] = X_WM.p + bodies_.q_WB[i] * bodies_.p_MB[i];
  // A body that is put elsewhere keeps its angular velocity.
  if (bodies_.is_dynamic(i)) bodies_.L_W[i] = model::angular_momentum(bodies_, i, w_W);
  model::refresh_derived(bodies_, i);
}

void World::set_mesh_pose(BodyId id, const Pose& X_WM) {
  require_finite(X_WM.p, "position");
  place(index(id), X_WM);
}

void World::set_velocity(BodyId id, const Vec3& v_W, const Vec3& w_W) {
  require_finite(v_W, "velocity");
  require_finite(w_W, "angular_velocity");
  const model::BodyIndex i = index(id);
  if (bodies_.kind[i] == model::BodyKind::fixed)
    throw InvalidArgument("body", names_[i], "a fixed body has no velocity");
  bodies_.v_W[i] = v_W;
  bodies_.w_W[i] = w_W;
  if (bodies_.is_dynamic(i)) bodies_.L_W[i] = model::angular_momentum(bodies_, i, w_W);
  model::refresh_derived(bodies_, i);
}

void World::apply_force(BodyId id, const Vec3& force_W, const Vec3& point_W) {
  const model::BodyIndex i = index(id);
  require_finite(force_W, "force");
  loads_.force[i] += force_W;
  loads_.torque[i] += (point_W - bodies_.x_W[i]).cross(force_W);
}

void World::apply_torque(BodyId id, const Vec3& torque_W) {
  require_finite(torque_W, "torque");
  loads_.torque[index(id)] += torque_W;
}

void World::apply_impulse(BodyId id, const Vec3& impulse_W, const Vec3& point_W) {
  const model::BodyIndex i = index(id);
  require_finite(impulse_W, "impulse");
  if (!bodies_.is_dynamic(i)) return;
  bodies_.v_W[i] += bodies_.inverse_mass[i] * impulse_W;
  bodies_.L_W[i] += (point_W - bodies_.x_W[i]).cross(impulse_W);
  model::refresh_derived(bodies_, i);
}

std::vector<BodyContact> World::contacts_of(BodyId id) const {
  const model::BodyIndex i = index(id);
  std::vector<BodyContact> found;
  for (const model::ContactPair& pair : contacts_.pairs) {
    if (pair.body_a != i && pair.body_b != i) continue;
    const bool is_a = pair.body_a == i;
    const double sign = is_a ? 1.0 : -1.0;
    for (std::uint32_t k = pair.begin; k < pair.end; ++k)
      found.push_back({ids_[is_a ? pair.body_b : pair.body_a], contacts_.point_W[k],
                       sign * contacts_.normal_W[k], contacts_.gap[k],
                       sign * update_.contact_impulse[k]});
  }
  return found;
}

}  // namespace gotai
