#include "gotai/model/body_state.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "gotai/core/error.h"

namespace gotai::model {
namespace {

/// Calls f on every column array, so that appending and erasing cannot forget one.
template <typename Function>
void for_each_column(BodyState& b, const Function& f) {
  f(b.x_W), f(b.q_WB), f(b.v_W), f(b.L_W);
  f(b.inverse_mass), f(b.I_B), f(b.principal_moments), f(b.q_BP), f(b.p_MB);
  f(b.bounding_radius), f(b.voxel_radius), f(b.half_extent);
  f(b.shape), f(b.material), f(b.kind), f(b.geometry);
  f(b.inverse_I_W), f(b.w_W);
}

}  // namespace

BodyIndex append_body(BodyState& bodies) {
  const auto index = static_cast<BodyIndex>(bodies.size());
  for_each_column(bodies, [](auto& column) { column.emplace_back(); });
  bodies.x_W[index] = bodies.v_W[index] = bodies.L_W[index] = bodies.w_W[index] = Vec3::Zero();
  bodies.p_MB[index] = bodies.half_extent[index] = bodies.principal_moments[index] = Vec3::Zero();
  bodies.q_WB[index] = bodies.q_BP[index] = Quat::Identity();
  bodies.I_B[index] = bodies.inverse_I_W[index] = Mat3::Zero();
  bodies.kind[index] = BodyKind::fixed;
  return index;
}

void erase_body(BodyState& bodies, BodyIndex index) {
  for_each_column(bodies, [index](auto& column) {
    column.erase(column.begin() + static_cast<std::ptrdiff_t>(index));
  });
}

void set_mass(BodyState& bodies, BodyIndex index, double mass, const Mat3& I_B) {
  if (!(mass > 0.0) || !std::isfinite(mass))
    throw InvalidArgument("mass", std::to_string(mass), "must be positive and finite [kg]");
  const Mat3 symmetric = 0.5 * (I_B + I_B.transpose());
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(symmetric);
  const Vec3& moments = eigen.eigenvalues();
  if (!moments.allFinite() || !(moments.minCoeff() > 0.0))
    throw InvalidArgument("inertia", "smallest moment " + std::to_string(moments.minCoeff()),
                          "must be positive definite [kg m^2]");
  Mat3 axes = eigen.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
  bodies.inverse_mass[index] = 1.0 / mass;
  bodies.I_B[index] = symmetric;
  bodies.principal_moments[index] = moments;
  bodies.q_BP[index] = Quat(axes).normalized();
  refresh_derived(bodies, index);
}

void refresh_derived(BodyState& bodies, BodyIndex index) {
  if (!bodies.is_dynamic(index)) return;
  const Mat3 R_WP = (bodies.q_WB[index] * bodies.q_BP[index]).toRotationMatrix();
  const Vec3 inverse_moments = bodies.principal_moments[index].cwiseInverse();
  const Mat3 scaled = R_WP * inverse_moments.asDiagonal();
  Mat3& inverse_I_W = bodies.inverse_I_W[index];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c)
      inverse_I_W(r, c) = inverse_I_W(c, r) =
          scaled(r, 0) * R_WP(c, 0) + scaled(r, 1) * R_WP(c, 1) + scaled(r, 2) * R_WP(c, 2);
  bodies.w_W[index] = bodies.inverse_I_W[index] * bodies.L_W[index];
}

void validate(const BodyState& bodies) {
  const std::size_t count = bodies.size();
  for_each_column(const_cast<BodyState&>(bodies), [count](const auto& column) {
    if (column.size() != count) throw SimulationError("body arrays have different lengths");
  });
  for (std::size_t i = 0; i < count; ++i) {
    const auto fail = [i](const char* what) {
      throw SimulationError("body " + std::to_string(i) + ": " + what);
    };
    if (!bodies.x_W[i].allFinite()) fail("position is not finite");
    if (!bodies.v_W[i].allFinite()) fail("velocity is not finite");
    if (!bodies.L_W[i].allFinite() || !bodies.w_W[i].allFinite()) fail("spin is not finite");
    if (!(std::abs(bodies.q_WB[i].norm() - 1.0) < 1e-9))
      fail("orientation is not a unit quaternion");
  }
}

}  // namespace gotai::model
