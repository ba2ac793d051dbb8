// Figs. 2-2, 4-3, 4-4, 4-7, 4-8, 4-10: impulses at one and at several contacts, and too long steps.
#include <fmt/format.h>

#include <cmath>

#include "thesis/contact_example.h"
#include "thesis/figures.h"

namespace gotai::experiments {
namespace {

Drawing draw_2_2() {
  // Both contacts on the same side of the centre of mass: the impulse at 2 lifts 1, too.
  const ContactExample example{{0.3, 1.0}, {0.0, -1.0}, 0.5};
  const ContactAnswer answer = solve_example(example);
  SvgDrawing svg(Vec2(-1.5, -1.0), Vec2(1.7, 1.1), 560.0);
  svg.rectangle(Vec2(-1.2, 0.0), Vec2(1.2, 0.25), kBody, kBodyFill);
  svg.circle(Vec2(0.0, 0.125), 0.03, kInk, kInk);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec2 at(example.arm[k], 0.0);
    svg.circle(at, 0.035, kInk, kVoxel);
    svg.text(at + Vec2(0.0, 0.32), fmt::format("{}", k + 1));
    if (answer.p[k] > 0.0) svg.arrow(at - Vec2(0.0, 0.6 * answer.p[k]), at, kVoxel, 2.0);
    svg.text(at - Vec2(0.0, 0.75), fmt::format("p = {:.3f}", answer.p[k]), 12.0);
    svg.text(at - Vec2(0.0, 0.92), fmt::format("v = {:g}, v' = {:.3f}", example.v[k], answer.v[k]),
             12.0);
  }
  svg.text(Vec2(0.0, 0.85), "v1' > -e v1 = 0: contact 2 pulls contact 1 away, and p1 = 0");
  return {svg.document(), answer.v[0] > 1e-6 && answer.p[0] < 1e-8,
          fmt::format("v1' = {:.4f}, p1 = {:.1e}", answer.v[0], answer.p[0])};
}

/// A ball that has just come to the floor, without gravity.
World ball_on_floor(model::ImpulseMethodName method, const Vec3& v_W) {
  Setup setup;
  setup.level = 1;
  setup.dt = 1e-6;  // the ball hardly turns while it is hit
  model::Settings settings = settings_of(setup);
  settings.gravity.setZero();
  settings.impulse.method = method;
  World world(settings);
  model::Material material;
  material.restitution = 0.5;
  material.friction = 0.0;
  world.set_default_material(material);
  world.add_plane({});
  geometry::GeneratorOptions sphere;
  sphere.shape = "sphere";
  const auto shape = prepare(sphere, 1, setup);
  add_unit_body(world, world.add_shape(shape),
                Vec3(0.0, 0.0, touching_height(*shape, Quat::Identity(), setup) - 1e-9),
                Quat::Identity(), v_W);
  return world;
}

Drawing draw_4_3() {
  const Vec3 before(1.0, 0.0, -1.0);
  World sem = ball_on_floor(model::ImpulseMethodName::sem, before);
  World constraint = ball_on_floor(model::ImpulseMethodName::constraint, before);
  const Vec3 x = sem.bodies().x_W[1];
  sem.step();
  constraint.step();
  // Of the point that touches, where a mass point would be; its arm is that before the step.
  const auto touching_velocity = [&](const World& world) -> Vec3 {
    const model::BodyState& bodies = world.bodies();
    return bodies.v_W[1] + bodies.w_W[1].cross(world.contacts().point_W[0] - x);
  };
  const Vec3 v_sem = touching_velocity(sem);
  const Vec3 v_c = touching_velocity(constraint);
  SvgDrawing svg(Vec2(-1.6, -0.55), Vec2(4.2, 1.5), 720.0);
  int column = 0;
  for (const auto& [name, after] : {std::pair("SEM", v_sem), {"constraint, e = 0.5", v_c}}) {
    const Vec2 shift(2.8 * column++, 0.0);
    svg.line(Vec2(-1.2, 0.0) + shift, Vec2(1.2, 0.0) + shift, kInk, 2.0);
    svg.arrow(Vec2(-1.0, 1.0) + shift, Vec2(-0.05, 0.05) + shift, kBody, 2.0);
    svg.circle(shift, 0.06, kInk, kBody);
    if (after.norm() > 1e-6) svg.arrow(shift, Vec2(after.x(), after.z()) + shift, kGood, 2.0);
    svg.text(Vec2(0.0, 1.3) + shift, name);
    svg.text(Vec2(0.0, -0.3) + shift,
             fmt::format("v = (1, -1), v' = ({:.3g}, {:.3g})", after.x() + 0.0, after.z() + 0.0));
  }
  return {svg.document(), v_sem.norm() < 1e-9,
          fmt::format("|v'| = {:.1e} by SEM, v' = ({:.2f}, {:.2f}) by constraints", v_sem.norm(),
                      v_c.x(), v_c.z())};
}

Drawing draw_4_4() {
  Setup setup;
  setup.level = 3;
  const geometry::GeneratorOptions cube;
  const auto shape = prepare(cube, 3, setup);
  const double offset = touching_height(*shape, Quat::Identity(), setup) - 0.5;
  SvgDrawing svg(Vec2(-1.6, -0.4), Vec2(1.9, 2.9), 420.0);
  svg.line(Vec2(-1.4, 0.0), Vec2(1.4, 0.0), kInk, 2.5);
  svg.rectangle(Vec2(-0.5, 1.5), Vec2(0.5, 2.5), kBody, kBodyFill, 1.5);
  for (const Vec3& c : shape->pyramid.voxel_centers(3))
    if (c.y() < 0.0 && c.y() > -0.4)
      svg.circle(Vec2(c.x(), c.z() + 2.0), shape->pyramid.grid.voxel_radius(3), kVoxel, "none");
  svg.circle(Vec2(0.0, 2.0), 0.03, kInk, kInk);
  svg.arrow(Vec2(0.9, 2.0), Vec2(0.9, 0.0), kSoft);
  svg.text(Vec2(1.0, 1.0), "2 m", 13.0, "start");
  svg.text(Vec2(0.0, 2.68), "cube of edge 1, v = 0, e = 0.5");
  svg.text(Vec2(0.0, -0.28), fmt::format("the spheres of level 3 reach {:.4f} m lower", offset));
  const double expected = 0.366 * 0.25;
  return {svg.document(), std::abs(offset - expected) < 1e-3 * expected,
          fmt::format("{:.5f} m", offset)};
}

Drawing draw_4_7() {
  constexpr int level = 3;
  SvgDrawing svg(Vec2(-0.9, -0.9), Vec2(4.5, 1.75), 820.0);
  std::string found;
  bool as_expected = true;
  int column = 0;
  for (const auto& [method, name, expected] : {std::tuple("S", "superposed", 12.48),
                                               {"I", "averaged", -0.158},
                                               {"C", "constraint", 0.5}}) {
    Setup setup;
    setup.method = method;
    setup.level = level;
    setup.dt = 1e-6;
    World world = world_with_floor(setup);
    const geometry::GeneratorOptions cube;
    const auto shape = prepare(cube, level, setup);
    add_unit_body(world, world.add_shape(shape),
                  Vec3(0.0, 0.0, touching_height(*shape, Quat::Identity(), setup) - 1e-9),
                  Quat::Identity(), Vec3(0.0, 0.0, -1.0));
    world.step();
    const Vec2 shift(1.85 * column++, 0.0);
    svg.rectangle(Vec2(-0.5, 0.0) + shift, Vec2(0.5, 1.0) + shift, kBody, kBodyFill);
    svg.line(Vec2(-0.7, -0.09) + shift, Vec2(0.7, -0.09) + shift, kInk, 2.0);
    for (std::size_t i = 0; i < world.contacts().size(); ++i) {
      const Vec3& at = world.contacts().point_W[i];
      if (at.y() < 0.0) continue;  // one of the rows is drawn twice as thick as it need be
      const double p = world.contact_impulses()[i].z();
      svg.arrow(Vec2(at.x(), -0.09 - 0.6 * p) + shift, Vec2(at.x(), -0.09) + shift, kVoxel, 1.6);
    }
    const double v = world.bodies().v_W[1].z();
    svg.text(Vec2(0.0, 1.45) + shift, name);
    svg.text(Vec2(0.0, 1.2) + shift, fmt::format("v = -1, v' = {:.3f}", v));
    found += fmt::format("{}{} {:.3f}", column > 1 ? ", " : "", method, v);
    as_expected = as_expected && std::abs(v - expected) < 0.02 * std::abs(expected);
  }
  return {svg.document(), as_expected, "v' = " + found};
}

/// Two balls on one line, each a single sphere.
World two_balls(double speed, double dt, double start) {
  Setup setup;
  setup.level = 1;
  setup.dt = dt;
  model::Settings settings = settings_of(setup);
  settings.gravity.setZero();
  World world(settings);
  model::Material material;
  material.restitution = 0.5;
  material.friction = 0.0;
  world.set_default_material(material);
  geometry::GeneratorOptions sphere;
  sphere.shape = "sphere";
  const ShapeId id = world.add_shape(prepare(sphere, 1, setup));
  add_unit_body(world, id, Vec3(-start, 0.0, 0.0), Quat::Identity(), Vec3(speed, 0.0, 0.0));
  add_unit_body(world, id, Vec3(start, 0.0, 0.2), Quat::Identity(), Vec3(-speed, 0.0, 0.0));
  return world;
}

Drawing draw_4_8() {
  World world = two_balls(1.0, 1e-3, 0.8);
  const model::ContactSet contacts = world.find_contacts_now();
  const Vec3 a = world.bodies().x_W[0];
  const Vec3 b = world.bodies().x_W[1];
  const Vec3 n = contacts.normal_W[0];
  const Vec3 point = contacts.point_W[0];
  const double before = n.dot(world.bodies().v_W[0] - world.bodies().v_W[1]);
  world.step();
  const double after = n.dot(world.bodies().v_W[0] - world.bodies().v_W[1]);
  SvgDrawing svg(Vec2(-2.1, -1.15), Vec2(2.1, 1.4), 640.0);
  const auto flat = [](const Vec3& x) { return Vec2(x.x(), x.z()); };
  const double r = world.shapes()[0]->pyramid.grid.voxel_radius(1);
  svg.circle(flat(a), r, kBody, kBodyFill);
  svg.circle(flat(b), r, kVoxel, kVoxelFill);
  svg.arrow(flat(a), flat(point), kInk, 1.5);
  svg.arrow(flat(b), flat(point), kInk, 1.5);
  svg.arrow(flat(point), flat(point + 0.6 * n), kGood, 2.5);
  svg.circle(flat(point), 0.03, kInk, kInk);
  svg.text(flat(a) + Vec2(0.25, -0.2), "r_A");
  svg.text(flat(b) + Vec2(-0.25, -0.2), "r_B");
  svg.text(flat(point + 0.6 * n) + Vec2(0.0, 0.1), "n");
  svg.text(flat(a) + Vec2(-0.4, 0.3), "A", 18.0);
  svg.text(flat(b) + Vec2(0.4, 0.3), "B", 18.0);
  svg.text(Vec2(0.0, 1.25), fmt::format("v = {:.4f} before, v' = {:.4f} after", before, after));
  return {svg.document(), std::abs(after + 0.5 * before) < 1e-8,
          fmt::format("v' / v = {:.6f}", after / before)};
}

Drawing draw_4_10() {
  SvgDrawing svg(Vec2(-3.4, -3.2), Vec2(3.4, 1.6), 720.0);
  bool as_expected = true;
  std::string found;
  int row = 0;
  for (const double safety : {0.5, 4.0}) {
    constexpr double speed = 5.0;
    constexpr double radius = 0.8660254037844386;  // of the single sphere of a ball of diameter 1
    const double dt = safety * radius / speed;
    World world = two_balls(speed, dt, 1.4);
    const Vec2 shift(0.0, -2.6 * row++);
    for (int k = 0; k < 2; ++k) {
      for (std::size_t i = 0; i < 2; ++i) {
        const Vec2 at = Vec2(world.bodies().x_W[i].x(), world.bodies().x_W[i].z()) + shift;
        svg.circle(at, radius, i == 0 ? kBody : kVoxel, k == 1 ? "none" : "#f3f5f7", k + 1.0);
        svg.text(at, fmt::format("{}{}", i == 0 ? "A" : "B", k == 0 ? "" : "'"));
      }
      if (k == 0)
        for (int steps = 0; steps < (safety < 1.0 ? 4 : 1); ++steps) world.step();
    }
    const bool passed = world.bodies().x_W[0].x() > world.bodies().x_W[1].x();
    svg.text(Vec2(0.0, 1.25) + shift,
             fmt::format("dt = {:g} r / v: {}", safety, passed ? "passed through" : "met"));
    found += fmt::format("{}{:g}: {}", row > 1 ? ", " : "", safety, passed ? "passed" : "met");
    as_expected = as_expected && passed == (safety > 1.0);
  }
  return {svg.document(), as_expected, found};
}

}  // namespace

std::vector<Figure> contact_figures() {
  return {{"2-2", "A contact that another contact's impulse pulls away", "v1' > 0 and p1 = 0",
           draw_2_2},
          {"4-3", "Impact of a mass point: SEM sticks", "v' = 0 by SEM", draw_4_3},
          {"4-4", "Start of the fall: a cube 2 m above the floor",
           "the spheres reach 0.366 s_3 below the cube", draw_4_4},
          {"4-7", "What superposed impulses do: one row of the contacts of a flat cube",
           "v' = 12.48 superposed, -0.158 averaged, 0.5 by constraints", draw_4_7},
          {"4-8", "One contact of two bodies", "v' = -e v", draw_4_8},
          {"4-10", "Voxel spheres pass through each other when the step is too long",
           "they meet at half the bound and pass at four times", draw_4_10}};
}

}  // namespace gotai::experiments
