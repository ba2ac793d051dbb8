#include "gotai/dynamics/step_control.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gotai::dynamics {

double speed_bound(const Vec3& v, const Vec3& w, double rho) { return v.norm() + rho * w.norm(); }

double speed_maximum(const Vec3& v, const Vec3& w, double rho) {
  const double spin = w.norm();
  if (spin == 0.0) return v.norm();
  const double along = v.dot(w) / spin;
  const double across = (v - (along / spin) * w).norm() + spin * rho;
  return std::hypot(along, across);
}

double step_bound(double voxel_radius, double v_max) {
  return v_max > 0.0 ? voxel_radius / v_max : std::numeric_limits<double>::infinity();
}

double derived_step(const model::BodyState& bodies, const model::Settings& settings) {
  const double g = settings.gravity.norm();
  double dt = settings.time.max_step;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.kind[i] == model::BodyKind::fixed || bodies.voxel_radius[i] <= 0.0) continue;
    const double speed = speed_bound(bodies.v_W[i], bodies.w_W[i], bodies.bounding_radius[i]);
    const double reach = settings.time.safety * bodies.voxel_radius[i];
    // dt (speed + g dt) = reach; written so that neither speed = 0 nor g = 0 divides by zero.
    const double denominator = speed + std::sqrt(speed * speed + 4.0 * g * reach);
    if (denominator > 0.0) dt = std::min(dt, 2.0 * reach / denominator);
  }
  return dt;
}

}  // namespace gotai::dynamics
