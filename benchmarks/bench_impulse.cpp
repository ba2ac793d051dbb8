/// What impulse methods cost and keep, on whole scenes. Each part is one bar of docs/methods.md:
///   bench_impulse apparent [LEVEL]    10 hexapods: impulse phase of exact and of apparent contacts
///   bench_impulse growth [SIDE] [SETTLE] [RESIDUAL]
///                                     iterative solver to the same residual: processor time per
///                                     contact for 4 layers of 5^2 and of SIDE^2 hexapods
///   bench_impulse rest [SECONDS]      a resting pile under every method: the energy it gains
///   bench_impulse residual [SIDE] [SETTLE]
///                                     solvers on the same state of a pile of 3 SIDE^2 hexapods on
///                                     reduced surface contacts: residual against time
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "gotai/core/stopwatch.h"
#include "gotai/geometry/generate.h"
#include "gotai/impulse/assembly.h"
#include "gotai/impulse/gauss_seidel_solver.h"
#include "gotai/impulse/warm_start.h"
#include "gotai/world/world.h"

namespace {

using namespace gotai;
using ShapePointer = std::shared_ptr<const voxel::Shape>;

ShapePointer hexapod(int level) {
  geometry::GeneratorOptions options;
  options.shape = "hexapod";
  return std::make_shared<const voxel::Shape>(voxel::make_shape(
      "hexapod", geometry::generate(options), {.prepared_level = level, .surface_level = 0}));
}

model::Settings settings_of(int level, double dt) {
  model::Settings settings;
  settings.gravity = Vec3(0, 0, -9.8);
  settings.collision.model = model::CollisionModel::spheres;
  settings.collision.level = level;
  settings.time.step = dt;
  return settings;
}

void set_surface(World& world, double restitution, double friction) {
  model::Material material;
  material.restitution = restitution;
  material.friction = friction;
  world.set_default_material(material);
}

/// `pile-time` of the experiments: hexapods above each other, lateral +-0.15 L, turned at random.
void add_column(World& world, const ShapePointer& shape, int count) {
  const ShapeId id = world.add_shape(shape);
  Random random(1);
  const double extent = 2.0;
  for (int i = 0; i < count; ++i) {
    BodyDescription body;
    body.shape = id;
    body.mass = 1.0;
    body.com_position =
        Vec3(random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15), 0.7 + 1.05 * i) * extent;
    body.X_WM.q = random.rotation();
    world.add_body(body);
  }
  world.add_plane({});
}

/// Sums over the steps of a run.
struct Totals {
  double impulse_s = 0.0;
  double contacts = 0.0;
  double rows = 0.0;
  double iterations = 0.0;
  double residual = 0.0;
};

/// Repeats every step from its state: the cheapest of the repeats is what it costs.
Totals time_steps(World& world, const std::vector<Snapshot>& states) {
  constexpr int repeats = 7;
  Totals totals;
  for (const Snapshot& state : states) {
    double cheapest = 1e30;
    for (int k = 0; k < repeats; ++k) {
      world.restore(state);
      const model::StepReport report = world.step();
      cheapest = std::min(cheapest, report.impulse_s);
      if (k > 0) continue;
      totals.contacts += report.contacts;
      totals.rows += report.solve.rows;
      totals.iterations += report.solve.iterations;
      totals.residual = std::max(totals.residual, report.solve.residual);
    }
    totals.impulse_s += cheapest;
  }
  return totals;
}

std::vector<Snapshot> states_of(World& world, int steps) {
  std::vector<Snapshot> states;
  for (int n = 0; n < steps; ++n) {
    states.push_back(world.snapshot());
    world.step();
  }
  return states;
}

/// All contacts, solved exactly, and apparent ones on the states of either run. On its own run
/// apparent contacts are more: bodies sink into each other.
void apparent(int level) {
  constexpr int steps = 300;
  const ShapePointer shape = hexapod(7);
  for (const double friction : {0.0, 0.3}) {
    const auto make_world = [&](model::ContactTreatment contacts) {
      model::Settings settings = settings_of(level, 0.01);
      settings.impulse.contacts = contacts;
      settings.impulse.solver = model::SolverName::exact;
      World world(settings);
      set_surface(world, 0.3, friction);
      add_column(world, shape, 10);
      return world;
    };
    World exact = make_world(model::ContactTreatment::all);
    World apparent = make_world(model::ContactTreatment::apparent);
    const std::vector<Snapshot> exact_states = states_of(exact, steps);
    const std::vector<Snapshot> apparent_states = states_of(apparent, steps);
    const auto show = [&](const char* name, World& world, const std::vector<Snapshot>& states) {
      const Totals totals = time_steps(world, states);
      fmt::print(
          "level {} mu {:.1f} {:24} {:6.2f} us/step, {:5.1f} contacts/step, {:5.1f} rows/step, "
          "{:5.1f} iterations/step, residual {:.1e}\n",
          level, friction, name, 1e6 * totals.impulse_s / steps, totals.contacts / steps,
          totals.rows / steps, totals.iterations / steps, totals.residual);
      return totals.impulse_s;
    };
    const double all = show("all contacts", exact, exact_states);
    const double same = show("apparent, same states", apparent, exact_states);
    const double own = show("apparent, its own run", apparent, apparent_states);
    fmt::print("  exact / apparent = {:.1f} on the same states, {:.1f} each on its own run\n",
               all / same, all / own);
  }
}

/// A pile of hexapods in a container, in layers, let down by the iterative solver.
World make_pile(const ShapePointer& shape, int per_side, int layers, double settle) {
  const double spacing = 2.1;
  model::Settings settings = settings_of(4, 0.01);
  settings.impulse.solver = model::SolverName::iterative;
  settings.impulse.tolerance = 1e-2;
  settings.impulse.max_iterations = 200;
  World world(settings);
  set_surface(world, 0.0, 0.5);
  const ShapeId id = world.add_shape(shape);
  Random random(3);
  for (int k = 0; k < layers; ++k) {
    for (int i = 0; i < per_side; ++i) {
      for (int j = 0; j < per_side; ++j) {
        BodyDescription body;
        body.shape = id;
        body.mass = 1.0;
        body.com_position =
            spacing * Vec3(i + 0.5 - 0.5 * per_side, j + 0.5 - 0.5 * per_side, k + 0.75);
        body.X_WM.q = random.rotation();
        world.add_body(body);
      }
    }
  }
  ContainerDescription box;
  box.inner = Vec3(spacing * per_side, spacing * per_side, 2.0 * spacing * layers);
  world.add_container(box);
  while (world.time() < settle) world.step();
  return world;
}

/// What solving the islands of a pile took, over some steps.
struct SolveCost {
  double cpu_s = 0.0;
  double contacts = 0.0;
  double sweeps = 0.0;    // of the largest island
  double residual = 0.0;  // largest [m/s]
};

/// Solves the contact problems of the world's next steps to the same residual [m/s], however fast
/// the fastest body is, warm-started; the world itself goes on with its own impulses.
SolveCost solve_steps(World& world, int steps, double residual) {
  SolveCost cost;
  model::ContactMemory memory;
  for (int n = -1; n < steps; ++n) {  // the first only warms up
    const model::ContactSet contacts = world.find_contacts_now();
    model::BodyState bodies = world.bodies();
    impulse::ContactTargets targets;
    impulse::read_targets(bodies, contacts, world.materials(), targets);
    const model::Settings& settings = world.settings();
    const double dt = settings.time.step;
    for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
      if (bodies.is_dynamic(i)) bodies.v_W[i] += dt * settings.gravity;
    }
    std::vector<Vec3> warm;
    impulse::recall(memory, contacts, warm);
    std::vector<Vec3> impulses(contacts.size(), Vec3::Zero());
    int sweeps = 0;
    std::vector<impulse::Island> islands;
    impulse::find_islands(bodies, contacts, islands);
    for (const impulse::Island& island : islands) {
      impulse::ConeProblem problem;
      std::vector<Mat3> frame;
      impulse::assemble(bodies, contacts, island, targets, contacts.gap, dt,
                        settings.gravity.norm(), settings.impulse.ridge, problem, frame);
      std::vector<std::uint32_t> index;
      std::vector<Vec3> guess;
      for (const std::uint32_t pair : island.pairs) {
        for (std::uint32_t i = contacts.pairs[pair].begin; i < contacts.pairs[pair].end; ++i) {
          guess.push_back(frame[index.size()].transpose() * warm[i]);
          index.push_back(i);
        }
      }
      impulse::ConeSolution solution;
      const std::clock_t start = std::clock();
      impulse::GaussSeidelSolver().solve(problem, &guess, residual, 10'000, solution);
      const double cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      for (std::size_t k = 0; k < index.size(); ++k) impulses[index[k]] = frame[k] * solution.p[k];
      if (n < 0) continue;
      cost.cpu_s += cpu_s;
      cost.contacts += static_cast<double>(problem.size());
      cost.residual = std::max(cost.residual, solution.residual);
      sweeps = std::max(sweeps, solution.iterations);
    }
    cost.sweeps += sweeps;
    impulse::remember(contacts, impulses, memory);
    world.step();
  }
  return cost;
}

void growth(int large_side, double settle, double residual) {
  constexpr int steps = 20;
  const ShapePointer shape = hexapod(7);
  double per_contact[2] = {0.0, 0.0};
  for (const int large : {0, 1}) {
    const int side = large == 0 ? 5 : large_side;
    World world = make_pile(shape, side, 4, settle);
    const SolveCost cost = solve_steps(world, steps, residual);
    per_contact[large] = cost.cpu_s / cost.contacts;
    fmt::print(
        "{:4} hexapods: {:7.1f} contacts/step, {:7.2f} us per contact and step, {:6.1f} sweeps, "
        "residual {:.1e} m/s\n",
        4 * side * side, cost.contacts / steps, 1e6 * per_contact[large], cost.sweeps / steps,
        cost.residual);
  }
  fmt::print("growth {:.2f}\n", per_contact[1] / per_contact[0]);
}

/// Solvers of the constraint method, each from the same state of a falling pile. The first steps
/// only warm up: what contacts remember from the sub-stepped solver is a sub-step's impulse.
void residual(int side, double settle) {
  constexpr int warm_up = 5;
  constexpr int steps = 20;
  constexpr int layers = 3;
  constexpr double spacing = 2.1;
  constexpr int level = 6;
  const auto shape = std::make_shared<const voxel::Shape>(
      voxel::make_shape("hexapod", geometry::generate({.shape = "hexapod"}),
                        {.prepared_level = level, .surface_level = level}));
  const auto make_world = [&](model::SolverName solver, double tolerance, int most_iterations) {
    model::Settings settings = settings_of(level, 1.0 / 60.0);
    settings.collision.model = model::CollisionModel::surface;
    settings.impulse.contacts = model::ContactTreatment::reduced;
    settings.impulse.solver = solver;
    settings.impulse.tolerance = tolerance;
    settings.impulse.max_iterations = most_iterations;
    World world(settings);
    set_surface(world, 0.2, 0.5);
    const ShapeId id = world.add_shape(shape);
    Random random(3);
    for (int k = 0; k < layers * side * side; ++k) {
      BodyDescription body;
      body.shape = id;
      body.mass = 1.0;
      body.com_position =
          spacing * Vec3(k % side + 0.5 - 0.5 * side, k / side % side + 0.5 - 0.5 * side,
                         k / (side * side) + 0.75);
      body.X_WM.q = random.rotation();
      world.add_body(body);
    }
    ContainerDescription box;
    box.inner = Vec3(spacing * side, spacing * side, 2.0 * spacing * layers);
    world.add_container(box);
    return world;
  };
  struct Candidate {
    const char* name;
    model::SolverName solver;
    double tolerance;
    int most_iterations;
  };
  using model::SolverName;
  const model::ImpulseSettings defaults;
  World start = make_world(SolverName::substepped, defaults.tolerance, defaults.max_iterations);
  start.run_until(settle);
  const Snapshot state = start.snapshot();
  fmt::print(
      "{} hexapods after {:g} s, {} contacts\n"
      "| solver | ms of impulses per step | residual m/s, mean / largest | iterations |\n"
      "|---|---|---|---|\n",
      layers * side * side, settle, start.contacts().size());
  for (const Candidate& c :
       {Candidate{"sub-stepped", SolverName::substepped, defaults.tolerance,
                  defaults.max_iterations},
        {"iterative, 10 sweeps", SolverName::iterative, 1e-12, 10},
        {"iterative, 30 sweeps", SolverName::iterative, 1e-12, 30},
        {"iterative, 100 sweeps", SolverName::iterative, 1e-12, 100},
        {"iterative, 300 sweeps", SolverName::iterative, 1e-12, 300},
        {"iterative, 1000 sweeps", SolverName::iterative, 1e-12, 1000},
        {"exact", SolverName::exact, defaults.tolerance, defaults.max_iterations}}) {
    World world = make_world(c.solver, c.tolerance, c.most_iterations);
    world.restore(state);
    double ms = 0.0;
    double sum = 0.0;
    double largest = 0.0;
    double iterations = 0.0;
    for (int n = 0; n < warm_up + steps; ++n) {
      const model::StepReport report = world.step();
      if (n < warm_up) continue;
      ms += 1e3 * report.impulse_s / steps;
      sum += report.solve.residual / steps;
      largest = std::max(largest, report.solve.residual);
      iterations += static_cast<double>(report.solve.iterations) / steps;
    }
    fmt::print("| {} | {:.2f} | {:.1e} / {:.1e} | {:.0f} |\n", c.name, ms, sum, largest,
               iterations);
    std::fflush(stdout);
  }
}

double fastest_body(const World& world) {
  double fastest = 0.0;
  for (const Vec3& v : world.bodies().v_W) fastest = std::max(fastest, v.norm());
  return fastest;
}

void rest(double seconds) {
  // At rest: after 10 s, when nothing moves by 0.01 mm/s: until then springs give back what they
  // stored. Apparent contacts rock and averaged impulses sink for ever.
  constexpr double least_settle = 10.0;
  constexpr double longest_settle = 20.0;
  constexpr double at_rest = 1e-5;
  struct Method {
    model::ImpulseMethodName name;
    model::ContactTreatment contacts;
    model::SolverName solver;
  };
  using model::ContactTreatment;
  using model::ImpulseMethodName;
  using model::SolverName;
  const ShapePointer shape = hexapod(5);
  for (const Method& method :
       {Method{ImpulseMethodName::constraint, ContactTreatment::all, SolverName::exact},
        {ImpulseMethodName::constraint, ContactTreatment::all, SolverName::iterative},
        {ImpulseMethodName::constraint, ContactTreatment::apparent, SolverName::exact},
        {ImpulseMethodName::impulse_averaged, ContactTreatment::all, SolverName::exact},
        {ImpulseMethodName::penalty, ContactTreatment::all, SolverName::exact},
        {ImpulseMethodName::sem, ContactTreatment::all, SolverName::exact},
        {ImpulseMethodName::vector_field, ContactTreatment::all, SolverName::exact},
        {ImpulseMethodName::impulse, ContactTreatment::all, SolverName::exact}}) {
    model::Settings settings = settings_of(4, 0.01);
    settings.impulse.method = method.name;
    settings.impulse.contacts = method.contacts;
    settings.impulse.solver = method.solver;
    settings.impulse.tolerance = 1e-8;
    World world(settings);
    set_surface(world, 0.3, 0.5);
    add_column(world, shape, 4);
    while (world.time() < least_settle ||
           (world.time() < longest_settle && fastest_body(world) > at_rest)) {
      world.step();
    }
    const double start_time = world.time();
    const double start = world.energy().total();
    double least = start;
    double gain = 0.0;
    double total_gain = 0.0;
    Stopwatch clock;
    while (world.time() < start_time + seconds) {
      world.step();
      const double energy = world.energy().total();
      gain = std::max(gain, energy - least);
      total_gain = std::max(total_gain, energy - start);
      least = std::min(least, energy);
    }
    fmt::print(
        "{:16} {:8} {:9} rests at {:4.1f} s, E(start) {:8.3f} J, highest above the start {:.2e} J, "
        "above the "
        "lowest before {:.2e} J, fastest at the end {:.1e} m/s, {:.1f} s\n",
        to_string(method.name), to_string(method.contacts), to_string(method.solver), start_time,
        start, total_gain, gain, fastest_body(world), clock.seconds());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const ThreadLimit one_thread(1);
  const std::string part = argc > 1 ? argv[1] : "";
  if (part == "apparent") {
    apparent(argc > 2 ? std::atoi(argv[2]) : 5);
  } else if (part == "growth") {
    growth(argc > 2 ? std::atoi(argv[2]) : 16, argc > 3 ? std::atof(argv[3]) : 1.0,
           argc > 4 ? std::atof(argv[4]) : 1e-3);
  } else if (part == "rest") {
    rest(argc > 2 ? std::atof(argv[2]) : 60.0);
  } else if (part == "residual") {
    residual(argc > 2 ? std::atoi(argv[2]) : 4, argc > 3 ? std::atof(argv[3]) : 1.5);
  } else {
    fmt::print(stderr,
               "usage: bench_impulse apparent [LEVEL] | growth [SIDE] [SETTLE] [RESIDUAL] | rest "
               "[SECONDS] | residual [SIDE] [SETTLE]\n");
    return 2;
  }
  return 0;
}
