// The same pile with the Open Dynamics Engine's triangle meshes.
#include "gotai/core/error.h"
#include "pile/pile.h"

#ifdef GOTAI_HAS_ODE
#include <fmt/format.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "gotai/geometry/mass_properties.h"

namespace gotai::pile {
namespace {

constexpr int kMostContacts = 32;  // per pair

struct Simulation {
  dWorldID world = nullptr;
  dSpaceID space = nullptr;
  dJointGroupID joints = nullptr;
  double contacts = 0.0;
};

void collide(void* data, dGeomID a, dGeomID b) {
  auto& simulation = *static_cast<Simulation*>(data);
  const dBodyID body_a = dGeomGetBody(a);
  const dBodyID body_b = dGeomGetBody(b);
  if (body_a == nullptr && body_b == nullptr) return;
  std::array<dContact, kMostContacts> contacts{};
  const int count = dCollide(a, b, kMostContacts, &contacts[0].geom, sizeof(dContact));
  for (int k = 0; k < count; ++k) {
    dContact& contact = contacts[static_cast<std::size_t>(k)];
    contact.surface.mode = dContactApprox1 | dContactBounce;
    contact.surface.mu = kFriction;
    contact.surface.bounce = kRestitution;
    contact.surface.bounce_vel = 2.0 * 9.81 * kStep;
    dJointAttach(dJointCreateContact(simulation.world, simulation.joints, &contact), body_a,
                 body_b);
  }
  simulation.contacts += count;
}

double energy(const std::vector<dBodyID>& bodies, const dMass& mass) {
  double sum = 0.0;
  for (const dBodyID body : bodies) {
    const Eigen::Map<const Vec3> v(dBodyGetLinearVel(body));
    const Eigen::Map<const Vec3> w(dBodyGetAngularVel(body));
    dVector3 w_B;
    dBodyVectorFromWorld(body, w.x(), w.y(), w.z(), w_B);
    double rotation = 0.0;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) rotation += w_B[r] * mass.I[4 * r + c] * w_B[c];
    // The correction of a semi-implicit step, as in World::energy().
    sum += 0.5 * mass.mass * v.squaredNorm() + 0.5 * rotation +
           mass.mass * 9.81 * dBodyGetPosition(body)[2] - 0.5 * kStep * mass.mass * 9.81 * v.z();
  }
  return sum;
}

}  // namespace

bool has_ode() { return true; }

Result run_ode(const Options& o, const Pile& pile) {
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  Simulation simulation;
  simulation.world = dWorldCreate();
  simulation.space = dHashSpaceCreate(nullptr);
  simulation.joints = dJointGroupCreate(0);
  dWorldSetGravity(simulation.world, 0.0, 0.0, -9.81);

  std::vector<double> vertices;
  for (const Vec3& x : pile.mesh.vertices) vertices.insert(vertices.end(), {x.x(), x.y(), x.z()});
  std::vector<dTriIndex> indices;
  for (const auto& t : pile.mesh.triangles) indices.insert(indices.end(), {t[0], t[1], t[2]});
  const dTriMeshDataID mesh = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(mesh, vertices.data(), 3 * sizeof(double),
                              static_cast<int>(vertices.size() / 3), indices.data(),
                              static_cast<int>(indices.size()), 3 * sizeof(dTriIndex));
  const geometry::MassProperties properties = geometry::mass_properties(pile.mesh);
  const Mat3 I = kDensity * properties.inertia;
  dMass mass;
  dMassSetParameters(&mass, kDensity * properties.volume, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2),
                     I(0, 1), I(0, 2), I(1, 2));
  const Vec3& centre = properties.center_of_mass;
  std::vector<dBodyID> bodies;
  for (const Pose& X : pile.poses) {
    const dBodyID body = dBodyCreate(simulation.world);
    dBodySetMass(body, &mass);
    const Vec3 x = X * centre;
    dBodySetPosition(body, x.x(), x.y(), x.z());
    const dQuaternion q = {X.q.w(), X.q.x(), X.q.y(), X.q.z()};
    dBodySetQuaternion(body, q);
    const dGeomID geom = dCreateTriMesh(simulation.space, mesh, nullptr, nullptr, nullptr);
    dGeomSetBody(geom, body);
    dGeomSetOffsetPosition(geom, -centre.x(), -centre.y(), -centre.z());
    bodies.push_back(body);
  }
  dCreatePlane(simulation.space, 0, 0, 1, 0);
  dCreatePlane(simulation.space, 1, 0, 0, -0.5 * pile.inner.x());
  dCreatePlane(simulation.space, -1, 0, 0, -0.5 * pile.inner.x());
  dCreatePlane(simulation.space, 0, 1, 0, -0.5 * pile.inner.y());
  dCreatePlane(simulation.space, 0, -1, 0, -0.5 * pile.inner.y());

  Result result;
  result.engine = "ODE, triangle meshes";
  const double initial = energy(bodies, mass);
  double highest = initial;
  const int steps = static_cast<int>(std::lround(o.seconds / kStep));
  const int rest_steps = std::min(steps, static_cast<int>(std::lround(1.0 / kStep)));
  for (int s = 0; s < steps; ++s) {
    const double start = cpu_seconds();
    dSpaceCollide(simulation.space, &simulation, &collide);
    dWorldQuickStep(simulation.world, kStep);
    dJointGroupEmpty(simulation.joints);
    const double ms = 1e3 * (cpu_seconds() - start);
    result.ms_per_step += ms / steps;
    if (s >= steps - rest_steps) result.ms_last_second += ms / rest_steps;
    result.ms_worst = std::max(result.ms_worst, ms);
    highest = std::max(highest, energy(bodies, mass));
    if (o.verbose && (s + 1) % 30 == 0) {
      fmt::print("  t {:5.2f} s  {:7.2f} ms\n", (s + 1) * kStep, ms);
      std::fflush(stdout);
    }
  }
  result.contacts = simulation.contacts / std::max(1, steps);
  result.energy_gain = (highest - initial) / std::abs(initial);
  double squares = 0.0;
  for (const dBodyID body : bodies) {
    const dReal* x = dBodyGetPosition(body);
    const dReal* q = dBodyGetQuaternion(body);
    Pose X{Vec3(x[0], x[1], x[2]), Quat(q[0], q[1], q[2], q[3])};
    X.p -= X.q * centre;
    result.poses.push_back(X);
    squares += Eigen::Map<const Vec3>(dBodyGetLinearVel(body)).squaredNorm();
  }
  result.rms_speed = std::sqrt(squares / std::max<double>(1.0, static_cast<double>(bodies.size())));
  dJointGroupDestroy(simulation.joints);
  dSpaceDestroy(simulation.space);
  dWorldDestroy(simulation.world);
  dGeomTriMeshDataDestroy(mesh);
  dCloseODE();
  return result;
}

}  // namespace gotai::pile
#else
namespace gotai::pile {
bool has_ode() { return false; }
Result run_ode(const Options&, const Pile&) {
  throw InvalidArgument("--compare", "ode", "needs libode-dev: scripts/setup --benchmarks");
}
}  // namespace gotai::pile
#endif
