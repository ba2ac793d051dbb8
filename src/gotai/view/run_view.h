/// @file
/// A run as the viewer takes it, from a recording or from a world that is still stepping.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/body_state.h"
#include "gotai/model/material.h"
#include "gotai/model/step.h"
#include "gotai/voxel/shape.h"
#include "gotai/world/world.h"

namespace gotai::view {

/// What stays the same about a body.
struct BodyView {
  std::string name;
  model::BodyKind kind = model::BodyKind::dynamic;
  model::Geometry geometry = model::Geometry::shape;
  std::uint32_t shape = 0;          ///< index into RunView::shapes
  std::uint32_t material = 0;       ///< index into RunView::materials
  double mass = 0.0;                ///< [kg]; 0 when it does not move by impulses
  double radius = 0.0;              ///< of the sphere about the centre of mass that holds it [m]
  Vec3 half_extent = Vec3::Zero();  ///< containers: inner half edges x, y and the height z [m]
};

/// A shape for drawing.
struct ShapeView {
  std::string name;
  std::shared_ptr<const geometry::Mesh> mesh;  ///< mesh frame; only its surface is drawn
  Vec3 center_of_mass = Vec3::Zero();          ///< [m], mesh frame
  voxel::VoxelGrid grid;
  /// Surface voxels (ix, iy, iz); voxels[h - 1] is level h.
  std::vector<std::vector<std::array<std::uint16_t, 3>>> voxels;
};

/// What stays the same about a run.
struct RunView {
  std::string title;
  std::string generator = "gotai";  ///< program and version that made the run
  std::vector<std::pair<std::string, std::string>> facts;  ///< settings and totals, for people
  std::vector<ShapeView> shapes;
  std::vector<model::Material> materials;
  std::vector<BodyView> bodies;
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]
  int level = 0;                ///< the level that the run collides at
};

/// Contacts of one moment, flat.
struct ContactsView {
  std::vector<std::uint32_t> body;  ///< a, b of each contact
  std::vector<Vec3> point_W;        ///< [m]
  std::vector<Vec3> normal_W;       ///< unit, from b to a
  std::vector<Vec3> impulse_W;      ///< on a, in the step that ended at the moment [N s]
  std::vector<double> gap;          ///< [m]

  std::size_t size() const { return gap.size(); }
};

/// One moment. Arrays have one entry per body; those of a body that is not there are NaN.
struct FrameView {
  double time = 0.0;      ///< [s]
  std::vector<Vec3> x_W;  ///< centre of mass [m]
  std::vector<Quat> q_WB;
  std::vector<Vec3> v_W;  ///< velocity [m/s]
  std::vector<Vec3> w_W;  ///< angular velocity [rad/s]
  ContactsView contacts;  ///< all that were found

  bool is_present(std::size_t body) const { return x_W[body].allFinite(); }
  /// Sum of the sizes of the contact impulses on each body [N s].
  std::vector<double> loads() const;
};

/// One curve of the charts.
struct Curve {
  std::string name;   ///< key of its values
  std::string label;  ///< as people read it
  std::string unit;
  std::string chart;  ///< curves with the same chart share axes
  double (*value)(const model::StepReport& report);
  bool peak = false;  ///< thinning keeps the largest value, not the last
};

/// All curves, in the order they are shown.
const std::vector<Curve>& curves();

/// Chapter 5's apparent contact points: per touching pair the centre of its contacts, weighted by
/// the normal parts of their impulses (5.8, with the impulses that 5.7 takes for proportional to
/// the approach speeds), the mean normal (5.11) and the whole impulse. For the method `apparent`
/// these are the points it solved for; for others, the points they amount to. Pairs without an
/// impulse have none. Contacts must be grouped by pair.
ContactsView apparent_contacts(const ContactsView& contacts);

/// A prepared shape for drawing.
ShapeView describe(const voxel::Shape& shape);
/// Settings as facts for people.
std::vector<std::pair<std::string, std::string>> describe(const model::Settings& settings);
/// What a world consists of. The title is left to the caller.
RunView describe(const World& world);
/// The present moment of a world.
FrameView capture(const World& world);

}  // namespace gotai::view
