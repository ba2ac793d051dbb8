#include "gotai/impulse/assembly.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "gotai/impulse/contact_kinematics.h"
#include "gotai/impulse/sliding.h"

namespace gotai::impulse {

void read_targets(const model::BodyState& bodies, const model::ContactSet& contacts,
                  const model::MaterialTable& materials, ContactTargets& targets) {
  targets.approach.resize(contacts.size());
  targets.restitution.resize(contacts.size());
  targets.friction.resize(contacts.size());
  targets.friction_W = contacts.friction_W;
  for (const model::ContactPair& pair : contacts.pairs) {
    const model::SurfacePair surface =
        materials.combine(bodies.material[pair.body_a], bodies.material[pair.body_b]);
    const RelativeMotion motion(bodies, pair);
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      targets.approach[i] = motion.along(contacts.normal_W[i], contacts.point_W[i]);
      targets.restitution[i] = surface.restitution;
      targets.friction[i] = surface.friction;
    }
  }
}

void slide_friction(const model::BodyState& bodies, const model::ContactSet& contacts,
                    double stopping_speed, ContactTargets& targets) {
  for (const model::ContactPair& pair : contacts.pairs) {
    const auto shares = sliding_shares(contacts, pair);
    if (shares.empty() || !is_sliding(bodies, contacts, pair, stopping_speed)) continue;
    for (const model::SlidingShare& share : shares) {
      targets.friction[share.contact] *= share.alignment;
      targets.friction_W[share.contact] = share.point_W;
    }
  }
}

double row_bias(double v, double v_star, double gap, double restitution, double dt,
                double gravity) {
  if (gap <= 0.0) return restitution * std::min(v, 0.0);
  const bool hits = v_star * dt < -gap;
  if (hits && restitution > 0.0 && v < -2.0 * gravity * dt) return restitution * v;
  return gap / dt;
}

Mat3 inertia_scale(const Mat3& inverse_I_W) { return inverse_I_W.llt().matrixL(); }

Jacobian mass_scaled_jacobian(const Mat3& frame, const Vec3& arm_W, const Vec3& friction_arm_W,
                              double inverse_mass, const Mat3& scale, double sign) {
  Jacobian J;
  J.leftCols<3>() = sign * std::sqrt(inverse_mass) * frame.transpose();
  for (int row = 0; row < 3; ++row) {
    const Vec3& arm = row == 0 ? arm_W : friction_arm_W;
    J.block<1, 3>(row, 3) = sign * arm.cross(frame.col(row)).transpose() * scale;
  }
  return J;
}

void assemble(const model::BodyState& bodies, const model::ContactSet& contacts,
              const Island& island, const ContactTargets& targets, const std::vector<double>& gap,
              double dt, double gravity, double ridge, ConeProblem& problem,
              std::vector<Mat3>& frame) {
  problem.clear();
  frame.clear();
  problem.blocks = island.bodies.size();
  problem.y_free.resize(static_cast<Eigen::Index>(6 * problem.blocks));
  std::vector<Mat3> scale(problem.blocks);
  for (std::size_t b = 0; b < problem.blocks; ++b) {
    const model::BodyIndex i = island.bodies[b];
    scale[b] = inertia_scale(bodies.inverse_I_W[i]);
    // w = S y and L = I w give y = S' L.
    problem.y_free.segment<6>(static_cast<Eigen::Index>(6 * b))
        << bodies.v_W[i] / std::sqrt(bodies.inverse_mass[i]),
        scale[b].transpose() * bodies.L_W[i];
  }

  std::vector<double> area;
  const auto couple = [&](model::BodyIndex body, std::size_t i, double sign) {
    if (!bodies.is_dynamic(body)) return;
    const auto at = std::lower_bound(island.bodies.begin(), island.bodies.end(), body);
    const auto block = static_cast<std::uint32_t>(at - island.bodies.begin());
    problem.couplings.push_back(
        {block, mass_scaled_jacobian(frame.back(), contacts.point_W[i] - bodies.x_W[body],
                                     targets.friction_W[i] - bodies.x_W[body],
                                     bodies.inverse_mass[body], scale[block], sign)});
  };
  problem.patch.push_back(0);
  for (const std::uint32_t k : island.pairs) {
    const model::ContactPair& pair = contacts.pairs[k];
    const RelativeMotion motion(bodies, pair);
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      frame.push_back(contact_frame(contacts.normal_W[i]));
      couple(pair.body_a, i, 1.0);
      couple(pair.body_b, i, -1.0);
      problem.first.push_back(static_cast<std::uint32_t>(problem.couplings.size()));

      const double v_star = motion.along(contacts.normal_W[i], contacts.point_W[i]);
      Vec3 bias = Vec3::Zero();
      bias.x() = row_bias(targets.approach[i], v_star, gap[i], targets.restitution[i], dt, gravity);
      // Bodies that impulses do not move have no block; their motion (kinematic) is part of the
      // bias.
      for (const model::BodyIndex body : {pair.body_a, pair.body_b}) {
        if (bodies.is_dynamic(body)) continue;
        const double sign = body == pair.body_a ? 1.0 : -1.0;
        const auto velocity = [&](const Vec3& at_W) {
          return Vec3(bodies.v_W[body] + bodies.w_W[body].cross(at_W - bodies.x_W[body]));
        };
        bias.x() += sign * frame.back().col(0).dot(velocity(contacts.point_W[i]));
        bias.tail<2>() +=
            sign * (frame.back().rightCols<2>().transpose() * velocity(targets.friction_W[i]));
      }
      problem.bias.push_back(bias);
      problem.friction.push_back(targets.friction[i]);
      area.push_back(contacts.area[i]);
    }
    problem.patch.push_back(static_cast<std::uint32_t>(problem.size()));
  }
  set_compliance(problem, area, ridge);
}

}  // namespace gotai::impulse
