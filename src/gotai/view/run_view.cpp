#include "gotai/view/run_view.h"

#include <fmt/format.h>

#include <algorithm>

namespace gotai::view {

std::vector<double> FrameView::loads() const {
  std::vector<double> sums(x_W.size(), 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double size = contacts.impulse_W[i].norm();
    sums[contacts.body[2 * i]] += size;
    sums[contacts.body[2 * i + 1]] += size;
  }
  return sums;
}

const std::vector<Curve>& curves() {
  using model::StepReport;
  static const std::vector<Curve> all{
      {"kinetic", "kinetic", "J", "Energy", [](const StepReport& r) { return r.energy.kinetic; }},
      {"potential", "potential", "J", "Energy",
       [](const StepReport& r) { return r.energy.potential; }},
      {"total", "total", "J", "Energy", [](const StepReport& r) { return r.energy.total(); }},
      {"contacts", "contacts", "", "Contacts",
       [](const StepReport& r) { return static_cast<double>(r.contacts); }, true},
      {"pairs", "pairs", "", "Contacts",
       [](const StepReport& r) { return static_cast<double>(r.pairs); }, true},
      {"overlap_max", "largest", "mm", "Overlap",
       [](const StepReport& r) { return 1e3 * r.max_overlap; }, true},
      {"overlap_mean", "mean", "mm", "Overlap",
       [](const StepReport& r) { return 1e3 * r.mean_overlap; }, true},
      {"residual", "residual", "m/s", "Residual",
       [](const StepReport& r) { return r.solve.residual; }, true},
      {"collision_ms", "collision", "ms", "Time per step",
       [](const StepReport& r) { return 1e3 * r.collision_s; }, true},
      {"impulse_ms", "impulses", "ms", "Time per step",
       [](const StepReport& r) { return 1e3 * r.impulse_s; }, true},
      {"integration_ms", "integration", "ms", "Time per step",
       [](const StepReport& r) { return 1e3 * r.integration_s; }, true},
      {"other_ms", "other", "ms", "Time per step",
       [](const StepReport& r) { return 1e3 * r.other_s; }, true},
  };
  return all;
}

ContactsView apparent_contacts(const ContactsView& contacts) {
  ContactsView out;
  for (std::size_t begin = 0, end = 0; begin < contacts.size(); begin = end) {
    const std::uint32_t a = contacts.body[2 * begin];
    const std::uint32_t b = contacts.body[2 * begin + 1];
    double weight = 0.0;
    double gap = 0.0;
    Vec3 point = Vec3::Zero();
    Vec3 normal = Vec3::Zero();
    Vec3 impulse = Vec3::Zero();
    for (; end < contacts.size() && contacts.body[2 * end] == a && contacts.body[2 * end + 1] == b;
         ++end) {
      const double w = std::max(contacts.impulse_W[end].dot(contacts.normal_W[end]), 0.0);
      weight += w;
      gap += w * contacts.gap[end];
      point += w * contacts.point_W[end];
      normal += w * contacts.normal_W[end];
      impulse += contacts.impulse_W[end];
    }
    // Opposed normals (a groove) leave no direction.
    if (weight <= 0.0 || normal.norm() <= 1e-9 * weight) continue;
    out.body.insert(out.body.end(), {a, b});
    out.point_W.push_back(point / weight);
    out.normal_W.push_back(normal.normalized());
    out.impulse_W.push_back(impulse);
    out.gap.push_back(gap / weight);
  }
  return out;
}

ShapeView describe(const voxel::Shape& shape) {
  ShapeView view;
  view.name = shape.name;
  view.mesh = std::make_shared<const geometry::Mesh>(shape.mesh);
  view.center_of_mass = shape.mass.center_of_mass;
  view.grid = shape.pyramid.grid;
  for (const voxel::PyramidLevel& level : shape.pyramid.levels) view.voxels.push_back(level.index);
  return view;
}

std::vector<std::pair<std::string, std::string>> describe(const model::Settings& settings) {
  const Vec3& g = settings.gravity;
  return {
      {"Method", std::string(model::to_string(settings.impulse.method))},
      {"Contacts", std::string(model::to_string(model::contact_treatment(settings)))},
      {"Collision", fmt::format("{}, level {}", model::to_string(settings.collision.model),
                                settings.collision.level)},
      {"Step", settings.time.step > 0.0 ? fmt::format("{:g} ms", 1e3 * settings.time.step)
                                        : std::string("derived (auto)")},
      {"Integrator", std::string(model::to_string(settings.time.integrator))},
      {"Gravity", fmt::format("{:g} {:g} {:g} m/s²", g.x(), g.y(), g.z())},
  };
}

RunView describe(const World& world) {
  RunView run;
  const model::BodyState& bodies = world.bodies();
  for (const auto& shape : world.shapes()) run.shapes.push_back(describe(*shape));
  run.materials = world.materials().materials;
  run.gravity = world.settings().gravity;
  run.level = world.settings().collision.level;
  run.facts = describe(world.settings());
  for (model::BodyIndex i = 0; i < bodies.size(); ++i)
    run.bodies.push_back({world.body_name(i), bodies.kind[i], bodies.geometry[i], bodies.shape[i],
                          bodies.material[i],
                          bodies.is_dynamic(i) ? 1.0 / bodies.inverse_mass[i] : 0.0,
                          bodies.bounding_radius[i], bodies.half_extent[i]});
  return run;
}

FrameView capture(const World& world) {
  const model::BodyState& bodies = world.bodies();
  const model::ContactSet& found = world.contacts();
  const std::vector<Vec3>& impulses = world.contact_impulses();
  FrameView frame;
  frame.time = world.time();
  frame.x_W = bodies.x_W;
  frame.q_WB = bodies.q_WB;
  frame.v_W = bodies.v_W;
  frame.w_W = bodies.w_W;
  frame.contacts.point_W = found.point_W;
  frame.contacts.normal_W = found.normal_W;
  frame.contacts.gap = found.gap;
  frame.contacts.impulse_W = impulses;
  frame.contacts.impulse_W.resize(found.size(), Vec3::Zero());
  frame.contacts.body.resize(2 * found.size());
  for (const model::ContactPair& pair : found.pairs)
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      frame.contacts.body[std::size_t{2} * i] = pair.body_a;
      frame.contacts.body[std::size_t{2} * i + 1] = pair.body_b;
    }
  return frame;
}

}  // namespace gotai::view
