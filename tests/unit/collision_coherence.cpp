// What searches remember of earlier steps makes them cheaper and changes no bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gotai/collision/find_contacts.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;

std::shared_ptr<const voxel::Shape> make(const std::string& name) {
  geometry::GeneratorOptions options;
  options.shape = name;
  voxel::ShapeOptions how;
  how.prepared_level = 4;
  how.surface_level = 5;
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(name, geometry::generate(options), how));
}

// A heap of bodies of several shapes that overlap and nearly touch.
struct Heap {
  model::BodyState bodies;
  std::vector<std::shared_ptr<const voxel::Shape>> shapes = {make("hexapod"), make("rock"),
                                                             make("torus"), make("cube")};
  Random random{41};

  Heap() {
    for (std::uint32_t i = 0; i < 40; ++i) {
      const BodyIndex b = model::append_body(bodies);
      bodies.geometry[b] = model::Geometry::shape;
      bodies.kind[b] = model::BodyKind::dynamic;
      give_shape(b, i % 4);
      bodies.x_W[b] =
          Vec3(random.uniform(0.0, 2.5), random.uniform(0.0, 2.5), random.uniform(0.0, 2.5));
      bodies.q_WB[b] = random.rotation();
      model::refresh_derived(bodies, b);
    }
  }
  void give_shape(BodyIndex b, std::uint32_t index) {
    const voxel::Shape& shape = *shapes[index];
    bodies.shape[b] = index;
    model::set_mass(bodies, b, shape.mass.volume, shape.mass.inertia);
    bodies.p_MB[b] = shape.mass.center_of_mass;
    bodies.bounding_radius[b] = shape.bounding_radius;
  }
  // Moves every body by about this much [m].
  void move(double distance, double dt) {
    for (BodyIndex b = 0; b < bodies.size(); ++b) {
      const Vec3 v = random.uniform(0.0, distance) * random.unit_vector() / dt;
      const Vec3 w = random.uniform(0.0, distance) * random.unit_vector() / dt;
      bodies.x_W[b] += dt * v;
      const Quat turn(Eigen::AngleAxisd(w.norm() * dt, w.normalized()));
      bodies.q_WB[b] = (turn * bodies.q_WB[b]).normalized();
      bodies.v_W[b] = v;
      bodies.w_W[b] = w;
    }
  }
};

// Slow motion, rest, sudden jumps, other shapes in the same columns; all and reduced contacts.
TEST(Coherence, ChangesNoBitAndSavesMostOfTheSearchAtRest) {
  for (const auto treatment : {model::ContactTreatment::all, model::ContactTreatment::reduced}) {
    Heap heap;
    model::CollisionSettings settings;
    settings.model = model::CollisionModel::surface;
    const SearchOptions options{treatment, 1.0 / 60.0, {}};
    CollisionCache cache;
    model::ContactSet remembering;
    model::ContactSet fresh;
    std::uint64_t tests_at_rest = 0;
    std::uint64_t fresh_tests_at_rest = 0;
    std::size_t contacts = 0;
    for (int step = 0; step < 60; ++step) {
      const bool at_rest = step >= 30;
      double distance = at_rest ? 1e-5 : 1e-3 * std::pow(2.0, step % 6);
      if (step == 20) distance = 0.3;
      heap.move(distance, options.dt);
      if (step == 25) heap.give_shape(7, 1);
      const SearchStatistics with =
          find_contacts(heap.bodies, heap.shapes, settings, 0.05, cache, remembering, options);
      CollisionCache none;
      const SearchStatistics without =
          find_contacts(heap.bodies, heap.shapes, settings, 0.05, none, fresh, options);
      ASSERT_EQ(remembering.feature, fresh.feature) << step;
      ASSERT_EQ(remembering.gap, fresh.gap) << step;
      ASSERT_EQ(remembering.normal_W, fresh.normal_W) << step;
      ASSERT_EQ(remembering.point_W, fresh.point_W) << step;
      ASSERT_EQ(remembering.friction_W, fresh.friction_W) << step;
      ASSERT_EQ(remembering.area, fresh.area) << step;
      contacts += fresh.size();
      if (step <= 30) continue;
      tests_at_rest += with.tests;
      fresh_tests_at_rest += without.tests;
    }
    EXPECT_GT(contacts, 1000U);
    RecordProperty("saved", std::to_string(static_cast<double>(fresh_tests_at_rest) /
                                           static_cast<double>(tests_at_rest)));
    EXPECT_LT(2 * tests_at_rest, fresh_tests_at_rest);
  }
}

// Contacts of pairs that moved less than the tolerance are nearly those of a new search.
TEST(Anchors, AdvanceContactsAsSearchesFindThem) {
  Heap heap;
  model::CollisionSettings settings;
  settings.model = model::CollisionModel::surface;
  SearchOptions fresh{model::ContactTreatment::reduced, 1.0 / 60.0, {}};
  SearchOptions anchored = fresh;
  model::ContactAnchors anchors;
  anchored.anchors = &anchors;
  CollisionCache cache;
  model::ContactSet found;
  model::ContactSet advanced;
  find_contacts(heap.bodies, heap.shapes, settings, 0.05, cache, advanced, anchored);
  const model::ContactAnchors before = anchors;
  ASSERT_GT(before.pairs.size(), 40U);
  heap.move(2e-5, fresh.dt);
  find_contacts(heap.bodies, heap.shapes, settings, 0.05, cache, advanced, anchored);
  find_contacts(heap.bodies, heap.shapes, settings, 0.05, cache, found, fresh);
  model::validate(advanced, heap.bodies.size());
  std::size_t kept = 0;
  for (const model::ContactAnchors::Pair& pair : before.pairs) {
    kept += std::ranges::any_of(anchors.pairs, [&](const model::ContactAnchors::Pair& now) {
      return now.body_a == pair.body_a && now.body_b == pair.body_b && now.X_BA.p == pair.X_BA.p;
    });
  }
  EXPECT_GT(10 * kept, 9 * before.pairs.size());
  std::vector<double> errors;
  std::size_t q = 0;
  for (const model::ContactPair& pair : advanced.pairs) {
    while (q < found.pairs.size() && std::pair(found.pairs[q].body_a, found.pairs[q].body_b) <
                                         std::pair(pair.body_a, pair.body_b)) {
      ++q;
    }
    if (q == found.pairs.size() || found.pairs[q].body_a != pair.body_a ||
        found.pairs[q].body_b != pair.body_b) {
      continue;
    }
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      for (std::uint32_t k = found.pairs[q].begin; k < found.pairs[q].end; ++k) {
        if (found.feature[k] != advanced.feature[i] || found.gap[k] < -0.01) continue;
        const double error = std::abs(found.gap[k] - advanced.gap[i]);
        errors.push_back(error);
      }
    }
  }
  // Not all are that near: a contact's normal is a mean over a cell, not the slope of its distance.
  ASSERT_GT(errors.size(), 50U);
  std::ranges::sort(errors);
  EXPECT_LT(errors[errors.size() / 2], 3e-6) << "of motions of 4e-5";
  // No pair has moved farther than 1e-4; but whether two edges cross is yes or no.
  EXPECT_LT(errors[errors.size() * 98 / 100], 1e-4);
}

}  // namespace
}  // namespace gotai::collision
