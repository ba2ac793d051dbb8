// Piles with contacts from the surfaces, reduced, and the sub-stepped solver: deep overlaps part
// gently.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "gotai/geometry/generate.h"
#include "gotai/world/world.h"

namespace gotai {
namespace {

constexpr int kLevel = 6;

std::shared_ptr<const voxel::Shape> shape_of(const std::string& name) {
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(name, geometry::generate({.shape = name}),
                        {.prepared_level = kLevel, .surface_level = kLevel}));
}

World world_with(const Vec3& gravity) {
  model::Settings settings;
  settings.gravity = gravity;
  settings.collision.model = model::CollisionModel::surface;
  settings.collision.level = kLevel;
  settings.impulse.contacts = model::ContactTreatment::reduced;
  settings.time.step = 1.0 / 60.0;
  World world(settings);
  model::Material material;
  material.friction = 0.5;
  material.restitution = 0.2;
  world.set_default_material(material);
  return world;
}

class DeepOverlap : public testing::TestWithParam<const char*> {};

// Eight bodies in a block, each a tenth of its size in its neighbours. They float, so that all the
// energy there is comes from parting; the pile's energy is what lifting it by its own height takes.
TEST_P(DeepOverlap, PartsWithoutABang) {
  World world = world_with(Vec3::Zero());
  const auto shape = shape_of(GetParam());
  const ShapeId id = world.add_shape(shape);
  const Box3 box = geometry::bounding_box(shape->mesh);
  const double size = box.sizes().maxCoeff();
  for (int k = 0; k < 8; ++k) {
    BodyDescription body;
    body.shape = id;
    body.X_WM.p = 0.9 * Vec3(k % 2, (k / 2) % 2, k / 4).cwiseProduct(box.sizes());
    world.add_body(body);
  }
  double mass = 0.0;
  for (model::BodyIndex i = 0; i < 8; ++i) mass += 1.0 / world.bodies().inverse_mass[i];
  double most = 0.0;
  double overlap = 0.0;
  for (int k = 0; k < 120; ++k) {
    const model::StepReport report = world.step();
    most = std::max(most, report.energy.total());
    if (k == 0) {
      EXPECT_GT(report.max_overlap, 0.02 * size);
    }
    overlap = report.max_overlap;
  }
  EXPECT_LT(most, 0.01 * mass * 9.81 * size);
  EXPECT_LT(overlap, 2e-3 * size);
}

INSTANTIATE_TEST_SUITE_P(Shapes, DeepOverlap,
                         testing::Values("cube", "sphere", "hexapod", "torus", "rock"),
                         [](const auto& shape) { return std::string(shape.param); });

}  // namespace
}  // namespace gotai
