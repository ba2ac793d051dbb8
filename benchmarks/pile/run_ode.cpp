// The same pile with the Open Dynamics Engine's triangle meshes.
#include "gotai/core/error.h"
#include "pile/rival.h"

#ifdef GOTAI_HAS_ODE
#include <ode/ode.h>

#include <array>

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

std::vector<Motion> motions_of(const std::vector<dBodyID>& bodies) {
  std::vector<Motion> motions;
  for (const dBodyID body : bodies) {
    const dReal* q = dBodyGetQuaternion(body);
    motions.push_back({Vec3(dBodyGetPosition(body)), Vec3(dBodyGetLinearVel(body)),
                       Vec3(dBodyGetAngularVel(body)), Quat(q[0], q[1], q[2], q[3])});
  }
  return motions;
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

  const auto step = [&simulation] {
    dSpaceCollide(simulation.space, &simulation, &collide);
    dWorldQuickStep(simulation.world, kStep);
    dJointGroupEmpty(simulation.joints);
  };
  Result result = simulate(o, pile,
                           {.name = "ODE, triangle meshes",
                            .step = step,
                            .motions = [&bodies] { return motions_of(bodies); },
                            .contacts = &simulation.contacts});
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
  throw InvalidArgument("--compare", "ode", "is not in this build");
}
}  // namespace gotai::pile
#endif
