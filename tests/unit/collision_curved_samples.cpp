// The smooth surface around samples of fine meshes.
#include "gotai/collision/curved_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gotai/geometry/generate.h"
#include "gotai/voxel/shape.h"

namespace gotai::collision {
namespace {

struct Case {
  voxel::Shape shape;
  voxel::SignedDistance surface;
  CurvedSamples curved;
  explicit Case(const geometry::GeneratorOptions& options)
      : shape(voxel::make_shape(options.shape, geometry::generate(options),
                                {.prepared_level = 3, .surface_level = 5})),
        surface(shape.mesh),
        curved(shape.surface, surface) {}
  std::size_t size() const { return shape.surface.tree.size(); }
};

TEST(CurvedSamples, OfABallAllFindTheSamePoint) {
  const Case ball({.shape = "rock", .size = 1.0, .subdivisions = 5, .roughness = 0.0});
  const Vec3 toward = Vec3(0.3, -0.5, 0.8).normalized();
  std::size_t near = 0;
  for (std::uint32_t s = 0; s < ball.size(); ++s) {
    const CurvedSample* c = ball.curved.find(s);
    ASSERT_NE(c, nullptr);
    EXPECT_NEAR(c->curvature[0], 2.0, 0.02);
    EXPECT_NEAR(c->curvature[1], 2.0, 0.02);
    const Eigen::Vector2d slide = slide_to_face(*c, toward);
    if (c->normal.dot(toward) < 0.0 || slide.norm() > ball.curved.reach()) continue;
    ++near;
    // The mesh itself is up to 1.2e-4 inside the ball.
    const Vec3 x = ball.shape.surface.center + slid_point(*c, slide);
    EXPECT_NEAR(x.dot(toward), 0.5, 1e-5);
    EXPECT_LE((x - 0.5 * toward).norm(), 2e-3);
  }
  EXPECT_GE(near, 4U);
}

TEST(CurvedSamples, OfATorusTellBothCurvatures) {
  const Case torus({.shape = "torus", .size = 1.0, .subdivisions = 24, .thickness = 0.5});
  const double tube = 0.5 / 3.0;
  const double ring = 2.0 * tube;
  std::size_t found = 0;
  for (std::uint32_t s = 0; s < torus.size(); ++s) {
    const CurvedSample* c = torus.curved.find(s);
    if (c == nullptr) continue;
    ++found;
    const Vec3 x = c->point + torus.shape.surface.center;
    const double radius = x.head<2>().norm();
    const double around = (radius - ring) / (tube * radius);
    EXPECT_NEAR(std::max(c->curvature[0], c->curvature[1]), 1.0 / tube, 0.05 / tube);
    if (std::abs(around) > 0.1) {
      EXPECT_NEAR(std::min(c->curvature[0], c->curvature[1]), around, 0.05 / tube);
    }
  }
  EXPECT_GT(found, torus.size() / 2);
}

TEST(CurvedSamples, AreNeitherFlatNorOfBentEdges) {
  for (const char* name : {"cube", "hexapod", "rock"}) {
    const Case solid({.shape = name, .size = 1.0});
    std::size_t found = 0;
    for (std::uint32_t s = 0; s < solid.size(); ++s) found += solid.curved.find(s) != nullptr;
    EXPECT_LE(found, solid.size() / 20) << name;
  }
}

}  // namespace
}  // namespace gotai::collision
