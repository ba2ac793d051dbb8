/// @file
/// A world of rigid bodies: owns the state and steps it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gotai/collision/find_contacts.h"
#include "gotai/collision/overlaps.h"
#include "gotai/core/hash.h"
#include "gotai/dynamics/integrate.h"
#include "gotai/impulse/method.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_anchors.h"
#include "gotai/model/contact_memory.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/material.h"
#include "gotai/model/settings.h"
#include "gotai/model/step.h"
#include "gotai/voxel/shape.h"
#include "gotai/world/body_description.h"
#include "gotai/world/snapshot.h"

namespace gotai {

/// Name of a body that stays valid when other bodies are removed. Never reused.
struct BodyId {
  std::uint32_t value = 0;
  // clang-tidy takes the zero in a defaulted comparison for a pointer.
  // NOLINTNEXTLINE(modernize-use-nullptr)
  friend auto operator<=>(const BodyId&, const BodyId&) = default;
};
using ShapeId = std::uint32_t;
using MaterialId = std::uint32_t;

/// One contact of a body, as read back after a step.
struct BodyContact {
  BodyId other;
  Vec3 point_W;    ///< [m]
  Vec3 normal_W;   ///< unit, towards the body asked for
  double gap;      ///< [m]
  Vec3 impulse_W;  ///< on the body asked for, over the last step [N s]
};

/// Rigid bodies, their shapes and materials, and the settings that move them.
///
/// Between steps everything may be read and changed; a step is deterministic: the same calls give
/// the same bits for any number of threads.
class World {
 public:
  using Shapes = std::vector<std::shared_ptr<const voxel::Shape>>;
  /// Called after every step with the world and the report of the step.
  using Observer = std::function<void(const World&, const model::StepReport&)>;

  /// @throws InvalidArgument when a setting is impossible
  explicit World(const model::Settings& settings = {});

  // ---- building
  /// @throws InvalidArgument when the shape is prepared to a coarser level than the settings ask
  /// for
  ShapeId add_shape(std::shared_ptr<const voxel::Shape> shape);
  MaterialId add_material(const model::Material& material);
  void set_material_pair(MaterialId a, MaterialId b, const model::SurfacePair& pair);
  void set_default_material(const model::Material& material);
  /// @throws InvalidArgument naming the impossible value
  BodyId add_body(const BodyDescription& description);
  BodyId add_plane(const PlaneDescription& description);
  BodyId add_container(const ContainerDescription& description);
  void remove_body(BodyId id);

  // ---- reading and changing bodies
  const model::BodyState& bodies() const { return bodies_; }
  /// Column of a body. @throws InvalidArgument for an id that does not exist
  model::BodyIndex index(BodyId id) const;
  BodyId id(model::BodyIndex index) const { return ids_[index]; }
  const std::string& body_name(model::BodyIndex index) const { return names_[index]; }
  Pose mesh_pose(BodyId id) const { return bodies_.mesh_pose(index(id)); }
  /// Places the mesh frame.
  void set_mesh_pose(BodyId id, const Pose& X_WM);
  void set_velocity(BodyId id, const Vec3& v_W, const Vec3& w_W);
  /// Adds a force at a point for the coming step only [N], [m].
  void apply_force(BodyId id, const Vec3& force_W, const Vec3& point_W);
  /// Adds a torque for the coming step only [N m].
  void apply_torque(BodyId id, const Vec3& torque_W);
  /// Changes velocities at once by an impulse at a point [N s], [m].
  void apply_impulse(BodyId id, const Vec3& impulse_W, const Vec3& point_W);
  /// Contacts of a body in the last step.
  std::vector<BodyContact> contacts_of(BodyId id) const;

  // ---- stepping
  /// One step [Makino 2007, Fig. 4-9]: detect, compute impulses, update.
  /// @throws SimulationError naming step and body when the state stops being finite or the energy
  /// runs away
  model::StepReport step();
  /// Has the world come to this time [s]? Sums of equal steps may miss it by round-off.
  bool has_reached(double end) const { return end - time_ <= 1e-9 * last_dt_; }
  /// Steps until has_reached(end).
  void run_until(double end);
  void add_observer(Observer observer) { observers_.push_back(std::move(observer)); }

  // ---- measurements
  double time() const { return time_; }
  std::uint64_t step_count() const { return step_count_; }
  const model::Settings& settings() const { return settings_; }
  const Shapes& shapes() const { return shapes_; }
  const model::MaterialTable& materials() const { return materials_; }
  const model::ContactSet& contacts() const { return contacts_; }
  /// Impulse per contact of contacts() in the last step, on body a [N s].
  const std::vector<Vec3>& contact_impulses() const { return update_.contact_impulse; }
  model::Energy energy() const;
  /// Linear momentum of the dynamic bodies [kg m/s].
  Vec3 momentum() const;
  /// Angular momentum of the dynamic bodies about the world's origin [kg m^2/s].
  Vec3 angular_momentum() const;
  /// The state between two steps.
  Snapshot snapshot() const;
  /// Goes back to a state of this very world (same bodies in the same order).
  /// @throws InvalidArgument when the number of bodies differs
  void restore(const Snapshot& snapshot);
  /// Hash of the state: exactly what snapshot() holds.
  Hash128 state_hash() const;
  /// Contacts of the present poses, without stepping.
  model::ContactSet find_contacts_now() const;
  /// Pairs of bodies that overlap at the present poses, ascending.
  std::vector<collision::PairOverlap> find_overlaps_now() const;

 private:
  BodyId append(const std::string& name);
  void place(model::BodyIndex i, const Pose& X_WM);
  void aim_kinematic_bodies(double dt);
  void substep(const model::StepPlan& plan, model::StepReport& report);
  void check_state() const;

  model::Settings settings_;
  model::MaterialTable materials_;
  Shapes shapes_;

  // State (docs/architecture.md, "What is state").
  model::BodyState bodies_;
  model::ContactMemory memory_;
  model::ContactAnchors anchors_;
  double time_ = 0.0;
  double last_dt_ = 0.0;
  std::uint64_t step_count_ = 0;

  std::vector<BodyId> ids_;                          // per column, ascending
  std::vector<std::string> names_;                   // per column
  std::map<BodyId, std::vector<KeyFrame>> motions_;  // kinematic bodies
  std::uint32_t next_id_ = 0;
  dynamics::Loads loads_;

  std::unique_ptr<impulse::ImpulseMethod> method_;
  collision::CollisionCache cache_;
  model::ContactSet contacts_;
  std::vector<double> gaps_;  // current gap per contact [m]
  model::Update update_;
  std::vector<Observer> observers_;
};

}  // namespace gotai
