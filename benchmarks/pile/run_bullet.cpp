// The same pile with Bullet's triangle meshes that may move (GImpact).
#include "gotai/core/error.h"
#include "pile/rival.h"

#ifdef GOTAI_HAS_BULLET
// Its headers do not pass our warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wextra"
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>
#pragma GCC diagnostic pop

#include <Eigen/Eigenvalues>
#include <cmath>
#include <memory>

#include "gotai/geometry/mass_properties.h"

namespace gotai::pile {
namespace {

btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btQuaternion to_bullet(const Quat& q) {
  return {static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()), static_cast<btScalar>(q.z()),
          static_cast<btScalar>(q.w())};
}
Quat from_bullet(const btQuaternion& q) { return Quat(q.w(), q.x(), q.y(), q.z()).normalized(); }

// Everything that a world of Bullet refers to, in the order in which it may be destroyed.
struct Simulation {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase;
  btSequentialImpulseConstraintSolver solver;
  btTriangleMesh triangles;
  std::unique_ptr<btGImpactMeshShape> shape;
  std::vector<std::unique_ptr<btStaticPlaneShape>> planes;
  std::vector<std::unique_ptr<btDefaultMotionState>> states;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  btDiscreteDynamicsWorld world{&dispatcher, &broad_phase, &solver, &configuration};
  Quat q_MB;  // of the principal axes, in which Bullet keeps inertia
  std::size_t moving = 0;
  double contacts = 0.0;

  ~Simulation() {
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }
  void add_body(double mass, btCollisionShape* form, const btVector3& inertia, const Vec3& x,
                const Quat& q) {
    states.push_back(
        std::make_unique<btDefaultMotionState>(btTransform(to_bullet(q), to_bullet(x))));
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), states.back().get(),
                                                  form, inertia);
    info.m_friction = static_cast<btScalar>(std::sqrt(kFriction));  // Bullet multiplies the two
    info.m_restitution = static_cast<btScalar>(std::sqrt(kRestitution));
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
  }
  void add_wall(const Vec3& normal, double distance) {
    planes.push_back(
        std::make_unique<btStaticPlaneShape>(to_bullet(normal), static_cast<btScalar>(distance)));
    planes.back()->setMargin(0.0F);
    add_body(0.0, planes.back().get(), btVector3(0, 0, 0), Vec3::Zero(), Quat::Identity());
  }
};

void fill(Simulation& simulation, const Pile& pile) {
  const geometry::MassProperties properties = geometry::mass_properties(pile.mesh);
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(properties.inertia);
  Mat3 axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  simulation.q_MB = Quat(axes);
  const auto corner = [&](std::uint32_t v) {
    return to_bullet(simulation.q_MB.conjugate() *
                     (pile.mesh.vertices[v] - properties.center_of_mass));
  };
  for (const auto& t : pile.mesh.triangles)
    simulation.triangles.addTriangle(corner(t[0]), corner(t[1]), corner(t[2]));
  simulation.shape = std::make_unique<btGImpactMeshShape>(&simulation.triangles);
  simulation.shape->setMargin(0.0F);  // bodies touch where their meshes do
  simulation.shape->updateBound();
  const double mass = kDensity * properties.volume;
  const btVector3 inertia = to_bullet(kDensity * principal.eigenvalues());
  for (const Pose& X : pile.poses) {
    simulation.add_body(mass, simulation.shape.get(), inertia, X * properties.center_of_mass,
                        X.q * simulation.q_MB);
  }
  simulation.moving = pile.poses.size();
  simulation.add_wall(Vec3::UnitZ(), 0.0);
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
    simulation.add_wall(axis, -0.5 * pile.inner.x());
    simulation.add_wall(-axis, -0.5 * pile.inner.x());
  }
}

std::vector<Motion> motions_of(const Simulation& simulation) {
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < simulation.moving; ++i) {
    const btRigidBody& body = *simulation.bodies[i];
    const btTransform& X = body.getCenterOfMassTransform();
    motions.push_back({from_bullet(X.getOrigin()), from_bullet(body.getLinearVelocity()),
                       from_bullet(body.getAngularVelocity()),
                       from_bullet(X.getRotation()) * simulation.q_MB.conjugate()});
  }
  return motions;
}

}  // namespace

bool has_bullet() { return true; }

Result run_bullet(const Options& o, const Pile& pile) {
  Simulation simulation;
  btGImpactCollisionAlgorithm::registerAlgorithm(&simulation.dispatcher);
  simulation.world.setGravity(btVector3(0, 0, -9.81F));
  fill(simulation, pile);
  const auto step = [&simulation] {
    simulation.world.stepSimulation(static_cast<btScalar>(kStep), 0);
    for (int m = 0; m < simulation.dispatcher.getNumManifolds(); ++m)
      simulation.contacts += simulation.dispatcher.getManifoldByIndexInternal(m)->getNumContacts();
  };
  return simulate(o, pile,
                  {.name = "Bullet, GImpact",
                   .step = step,
                   .motions = [&simulation] { return motions_of(simulation); },
                   .contacts = &simulation.contacts});
}

}  // namespace gotai::pile
#else
namespace gotai::pile {
bool has_bullet() { return false; }
Result run_bullet(const Options&, const Pile&) {
  throw InvalidArgument("--compare", "bullet", "is not in this build");
}
}  // namespace gotai::pile
#endif
