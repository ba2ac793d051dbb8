// Chapters 2 to 5: the flow charts, and all drawings as one experiment.
#include "thesis/figures.h"

#include <fmt/format.h>

#include "thesis/catalogue.h"
#include "thesis/drops.h"

namespace gotai::experiments {

std::string flow_chart(const std::vector<FlowBox>& boxes, int back_to) {
  const double n = static_cast<double>(boxes.size());
  SvgDrawing svg(Vec2(-0.4, -0.3), Vec2(6.6, 1.2 * n), 560.0);
  const auto top = [&](std::size_t k) { return 1.2 * (n - static_cast<double>(k)) - 0.2; };
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    svg.rectangle(Vec2(0.0, top(k) - 0.85), Vec2(5.6, top(k)), kVoxel, "#eef5fb", 1.2);
    svg.text(Vec2(2.8, top(k) - 0.36), boxes[k].head, 14.0);
    svg.text(Vec2(2.8, top(k) - 0.67), boxes[k].figures, 12.0, "middle", "#5a6672");
    if (k + 1 < boxes.size()) svg.arrow(Vec2(2.8, top(k) - 0.85), Vec2(2.8, top(k + 1)), kInk, 1.5);
  }
  if (back_to >= 0) {
    const double from = top(boxes.size() - 1) - 0.42;
    const double to = top(static_cast<std::size_t>(back_to)) - 0.42;
    svg.line(Vec2(5.6, from), Vec2(6.2, from), kInk, 1.5);
    svg.line(Vec2(6.2, from), Vec2(6.2, to), kInk, 1.5);
    svg.arrow(Vec2(6.2, to), Vec2(5.6, to), kInk, 1.5);
  }
  return svg.document();
}

namespace {

/// What a flow chart tells of a run: four hexapods fall for two seconds.
struct Flow {
  Totals totals;
  std::uint64_t steps = 0;
  std::uint64_t touching = 0;  // steps with contacts
  std::uint64_t contacts = 0;
  std::uint64_t rows = 0;  // unknowns that were solved for

  explicit Flow(World& world) : totals(world) {
    world.add_observer([this](const World&, const model::StepReport& report) {
      ++steps;
      touching += report.contacts > 0 ? 1 : 0;
      contacts += report.contacts;
      rows += report.solve.rows;
    });
  }
};

Flow run_flow(const char* method) {
  Setup setup;
  setup.method = method;
  setup.level = 5;
  setup.restitution = 0.3;
  setup.friction = 0.3;
  setup.reduced = setup.substepped = true;
  geometry::GeneratorOptions hexapod;
  hexapod.shape = "hexapod";
  Drop drop;
  drop.shape = prepare(hexapod, kFinestPrepared, setup);
  drop.extent = 2.0;
  World world = world_with_floor(setup);
  add_drop(world, drop);
  Flow flow(world);
  world.run_until(2.0);
  return flow;
}

std::string milliseconds(double seconds, std::uint64_t steps) {
  return fmt::format("{:.3f} ms a step", 1e3 * seconds / static_cast<double>(steps));
}

Drawing draw_2_1() {
  const Flow f = run_flow("C");
  return {flow_chart({{"detect collisions", milliseconds(f.totals.collision_s, f.steps)},
                      {"compute impulses", milliseconds(f.totals.impulse_s, f.steps)},
                      {"move the bodies", milliseconds(f.totals.integration_s, f.steps)}},
                     0),
          f.totals.collision_s > 0.0 && f.totals.impulse_s > 0.0 && f.totals.integration_s > 0.0,
          fmt::format("{} steps", f.steps)};
}

Drawing draw_4_9() {
  const Flow f = run_flow("C");
  return {flow_chart({{"load shapes, set the start", "4 hexapods, level 5, constraint-based"},
                      {"detect collisions level by level", fmt::format("{} tests", f.totals.tests)},
                      {"contacts?", fmt::format("{} of {} steps", f.touching, f.steps)},
                      {"solve the complementarity problem (4.16)",
                       fmt::format("{} contacts, {} unknowns", f.contacts, f.rows)},
                      {"update velocities, then positions (4.19)", fmt::format("dt = 1/100 s")}},
                     1),
          f.touching > 0 && f.rows == f.contacts,
          fmt::format("{} contacts, {} unknowns", f.contacts, f.rows)};
}

Drawing draw_5_6() {
  const Flow f = run_flow("A");
  return {flow_chart({{"load shapes, set the start", "4 hexapods, level 5, apparent contacts"},
                      {"detect collisions level by level", fmt::format("{} tests", f.totals.tests)},
                      {"contacts?", fmt::format("{} of {} steps", f.touching, f.steps)},
                      {"one apparent contact per pair (5.8, 5.11)",
                       fmt::format("{} contacts become {}", f.contacts, f.rows)},
                      {"solve (4.16) for them, spread back (5.18)", "friction at every contact"},
                      {"update velocities, then positions (4.19)", fmt::format("dt = 1/100 s")}},
                     1),
          f.rows > 0 && f.rows < f.contacts,
          fmt::format("{} contacts become {} unknowns", f.contacts, f.rows)};
}

std::vector<Figure> all_figures() {
  std::vector<Figure> all;
  for (const auto& some : {flow_figures(), voxel_figures(), contact_figures(), apparent_figures()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

Json draw(const Json& point, const std::string& /*folder*/) {
  for (const Figure& figure : all_figures())
    if (point["figure"] == figure.number) {
      const Drawing drawing = figure.draw();
      return {{"title", figure.title},
              {"check", figure.check},
              {"as_expected", drawing.as_expected},
              {"found", drawing.found},
              {"curves", {{"svg", drawing.svg}}}};
    }
  return {};
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  for (const Record& r : records) {
    const std::string number = "Fig. " + r["figure"].get<std::string>();
    outcome.pictures.push_back({number, r["title"], r["curves"]["svg"], ""});
    outcome.verdicts.push_back(
        {number + ": " + r["check"].get<std::string>(), "yes", r["found"], r["as_expected"]});
  }
  return outcome;
}

}  // namespace

std::vector<Figure> flow_figures() {
  return {{"2-1", "Flow of a rigid body simulation", "every phase takes time", draw_2_1},
          {"4-9", "The thesis's algorithm, with the figures of a run", "one unknown per contact",
           draw_4_9},
          {"5-6", "The algorithm with apparent contact points", "fewer unknowns than contacts",
           draw_5_6}};
}

Experiment figures() {
  return {"figures",
          "Figs. 2-1..5-6",
          "The figures of chapters 2 to 5, drawn from live data",
          "Every drawing is made from what the engine computes while the report is made, and one "
          "number of each is checked.",
          false,
          [](Effort) {
            std::vector<Json> points;
            for (const Figure& figure : all_figures())
              points.push_back({{"figure", figure.number}});
            return points;
          },
          draw,
          conclude};
}

}  // namespace gotai::experiments
