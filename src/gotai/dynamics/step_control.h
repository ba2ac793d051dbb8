/// @file
/// The time step that follows from level, speed and spin [Makino 2007, eqs. 4.27-4.29; errata
/// 28-30].
#pragma once

#include "gotai/model/body_state.h"
#include "gotai/model/settings.h"

namespace gotai::dynamics {

/// Upper bound of the speed of any contact surface of a body, |v| + rho |w| [m/s] (erratum 29).
double speed_bound(const Vec3& v, const Vec3& w, double rho);

/// Largest speed of any point of a ball of radius rho about the centre of mass:
/// sqrt(v_par^2 + (v_perp + |w| rho)^2), parts along and across w [m/s].
double speed_maximum(const Vec3& v, const Vec3& w, double rho);

/// r / v_max: the step in which no voxel sphere moves farther than its radius (4.27, 4.29) [s].
double step_bound(double voxel_radius, double v_max);

/// The derived step of all dynamic bodies:
///   safety * min over bodies of r / (|v| + rho |w| + |g| dt), dt solved for, capped at max_step
///   [s].
double derived_step(const model::BodyState& bodies, const model::Settings& settings);

}  // namespace gotai::dynamics
