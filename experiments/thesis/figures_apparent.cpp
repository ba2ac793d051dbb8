// Figs. 5-1..5-5: the apparent contact point, and what it loses unless impulses are spread back.
#include <fmt/format.h>

#include <cmath>

#include "gotai/impulse/apparent_contact.h"
#include "thesis/contact_example.h"
#include "thesis/figures.h"

namespace gotai::experiments {
namespace {

Drawing draw_5_1() {
  // A tilted cube that rocks onto its face: the outer contacts approach faster.
  Setup setup;
  setup.level = 4;
  World world = world_with_floor(setup);
  const geometry::GeneratorOptions cube;
  const auto shape = prepare(cube, 4, setup);
  const Vec3 x(0.0, 0.0, touching_height(*shape, Quat::Identity(), setup) - 0.001);
  add_unit_body(world, world.add_shape(shape), x, Quat::Identity(), Vec3(0.0, 0.0, -1.0),
                Vec3(0.0, 1.5, 0.0));
  const model::ContactSet contacts = world.find_contacts_now();
  std::vector<double> approach;
  for (const Vec3& p : contacts.point_W) {
    const Vec3 v = world.bodies().v_W[1] + world.bodies().w_W[1].cross(p - x);
    approach.push_back(v.z());
  }
  const impulse::ApparentContact apparent =
      impulse::apparent_contact(contacts.point_W, contacts.normal_W, approach);
  double moment = 0.0;
  SvgDrawing svg(Vec2(-0.9, -0.75), Vec2(0.9, 1.3), 480.0);
  svg.rectangle(Vec2(-0.5, 0.0), Vec2(0.5, 1.0), kBody, kBodyFill);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double w = std::max(0.0, -approach[i]);
    moment += w * (contacts.point_W[i].x() - apparent.point.x());
    const double px = contacts.point_W[i].x();
    svg.arrow(Vec2(px, -0.25 * w), Vec2(px, 0.0), kVoxel, 1.2);
  }
  svg.arrow(Vec2(apparent.point.x(), -0.6), Vec2(apparent.point.x(), 0.0), kGood, 3.0);
  svg.text(Vec2(apparent.point.x(), -0.7), "apparent contact point");
  svg.text(Vec2(0.0, 1.15), fmt::format("{} contacts become one", contacts.size()));
  return {svg.document(), apparent.exists && std::abs(moment) < 1e-12,
          fmt::format("sum of moments {:.1e}, r_a = {:.4f}", moment, apparent.point.x())};
}

Drawing two_contacts(double v1, double v2, bool apparent) {
  const ContactExample example{{-1.0, 1.0}, {v1, v2}, 0.5};
  const ContactAnswer answer = solve_example(example);
  const std::vector<Vec3> points{Vec3(-1.0, 0.0, -1.0), Vec3(1.0, 0.0, -1.0)};
  const std::vector<Vec3> normals(2, Vec3::UnitZ());
  const impulse::ApparentContact one = impulse::apparent_contact(points, normals, example.v);
  SvgDrawing svg(Vec2(-2.0, -2.4), Vec2(2.0, 1.5), 460.0);
  svg.rectangle(Vec2(-1.0, -1.0), Vec2(1.0, 1.0), kBody, kBodyFill);
  svg.circle(Vec2::Zero(), 0.04, kInk, kInk);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec2 at(points[k].x(), points[k].z());
    svg.arrow(at - Vec2(0.0, 0.6 * answer.p[k]), at, kVoxel, 2.0);
    svg.text(at + Vec2(0.0, -1.1), fmt::format("v{} = {:g}", k + 1, example.v[k]));
    svg.text(at + Vec2(0.0, -1.3), fmt::format("p{} = {:.4f}", k + 1, answer.p[k]));
  }
  const double expected_x = v1 / v2 > 1.5 ? -1.0 / 3.0 : 0.0;
  if (apparent) {
    const Vec2 at(one.point.x(), one.point.z());
    svg.line(Vec2::Zero(), at, kGood, 1.5);
    svg.circle(at, 0.07, kGood, kGood);
    svg.text(at + Vec2(0.0, 0.2), fmt::format("r_a = [{:.3f}, 0, {:g}]", at.x() + 0.0, at.y()));
  }
  const bool p_right =
      std::abs(answer.p[0] - 0.75 * -v1) < 1e-6 && std::abs(answer.p[1] - 0.75 * -v2) < 1e-6;
  return {svg.document(), p_right && std::abs(one.point.x() - expected_x) < 1e-12,
          fmt::format("p = ({:.4f}, {:.4f}), r_a = [{:.4f}, 0, {:g}]", answer.p[0], answer.p[1],
                      one.point.x() + 0.0, one.point.z())};
}

Drawing draw_5_2() { return two_contacts(-1.0, -1.0, false); }
Drawing draw_5_3() { return two_contacts(-1.0, -1.0, true); }
Drawing draw_5_4() { return two_contacts(-2.0, -1.0, true); }

Drawing draw_5_5() {
  Setup setup;
  setup.method = "A";
  setup.level = 3;
  setup.dt = 1e-3;
  setup.restitution = 0.0;
  setup.friction = 0.3;
  World world = world_with_floor(setup);
  const geometry::GeneratorOptions cube;
  const auto shape = prepare(cube, 3, setup);
  const Vec3 x(0.0, 0.0, touching_height(*shape, Quat::Identity(), setup) - 1e-9);
  const BodyId body = add_unit_body(world, world.add_shape(shape), x, Quat::Identity(),
                                    Vec3::Zero(), Vec3(0.0, 0.0, 10.0));
  const model::ContactSet contacts = world.find_contacts_now();
  const std::vector<double> sinking(contacts.size(), -1.0);
  const impulse::ApparentContact one =
      impulse::apparent_contact(contacts.point_W, contacts.normal_W, sinking);
  SvgDrawing svg(Vec2(-0.9, -1.0), Vec2(2.4, 1.0), 760.0);
  svg.rectangle(Vec2(-0.5, -0.5), Vec2(0.5, 0.5), kBody, kBodyFill);
  svg.line(Vec2(-0.8, -0.58), Vec2(0.8, -0.58), kInk, 2.0);
  svg.text(Vec2(0.0, 0.75), "from the side");
  svg.text(Vec2(0.0, -0.8), "spins about the vertical");
  const Vec2 shift(1.5, 0.0);
  svg.rectangle(Vec2(-0.5, -0.5) + shift, Vec2(0.5, 0.5) + shift, kBody, kBodyFill);
  for (const Vec3& p : contacts.point_W) {
    const Vec2 at = p.head<2>() + shift;
    const Vec2 slip = 0.35 * Vec2(-p.y(), p.x());
    svg.circle(at, 0.02, kVoxel, kVoxel);
    svg.arrow(at, at + slip, kVoxel, 1.2);
  }
  svg.circle(one.point.head<2>() + shift, 0.035, kGood, kGood);
  svg.text(Vec2(0.0, 0.75) + shift, "from below: the apparent point does not slip");
  while (world.time() < 2.0 && world.bodies().w_W[world.index(body)].z() > 1e-6) world.step();
  svg.text(Vec2(0.0, -0.8) + shift,
           fmt::format("spread back, friction stops it after {:.3f} s", world.time()));
  const bool on_axis = one.point.head<2>().norm() < 1e-12;
  return {svg.document(), on_axis && std::abs(world.time() - 1.5141) <= 2.0 * setup.dt,
          fmt::format("arm of the apparent point {:.0e} m, stops after {:.4f} s",
                      one.point.head<2>().norm(), world.time())};
}

}  // namespace

std::vector<Figure> apparent_figures() {
  return {{"5-1", "The apparent contact point of a rocking cube", "moments balance", draw_5_1},
          {"5-2", "Two contacts in two dimensions", "p = (0.75, 0.75)", draw_5_2},
          {"5-3", "Apparent contact point of the first example", "r_a = [0, 0, -1]", draw_5_3},
          {"5-4", "Apparent contact point of the second example",
           "p = (1.5, 0.75), r_a = [-1/3, 0, -1]", draw_5_4},
          {"5-5", "Where one apparent contact point is not enough (level 3)",
           "the point lies on the axis; spread back, the spin stops after 1.5141 s", draw_5_5}};
}

}  // namespace gotai::experiments
