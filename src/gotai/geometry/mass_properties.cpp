#include "gotai/geometry/mass_properties.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "gotai/core/error.h"

namespace gotai::geometry {

namespace {

/// Volume integrals of 1, x and x x^T about a local origin.
struct Moments {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();

  /// Adds the simplex with the given corners. For a linear map of the unit simplex the integral of
  /// x x^T is V/20 (sum_i x_i x_i^T + s s^T) with s = sum_i x_i.
  void add(double signed_volume, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 sum = a + b + c + d;
    volume += signed_volume;
    first += signed_volume / 4.0 * sum;
    second += signed_volume / 20.0 *
              (a * a.transpose() + b * b.transpose() + c * c.transpose() + d * d.transpose() +
               sum * sum.transpose());
  }
};

double six_volumes(const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c); }

Moments integrate_tetrahedra(const Mesh& mesh, const Vec3& origin) {
  Moments moments;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    const Vec3 a = mesh.vertices[tet[0]] - origin;
    const Vec3 b = mesh.vertices[tet[1]] - origin;
    const Vec3 c = mesh.vertices[tet[2]] - origin;
    const Vec3 d = mesh.vertices[tet[3]] - origin;
    moments.add(std::abs(six_volumes(b - a, c - a, d - a)) / 6.0, a, b, c, d);
  }
  return moments;
}

Moments integrate_surface(const Mesh& mesh, const Vec3& origin) {
  Moments moments;
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3 a = mesh.vertices[triangle[0]] - origin;
    const Vec3 b = mesh.vertices[triangle[1]] - origin;
    const Vec3 c = mesh.vertices[triangle[2]] - origin;
    moments.add(six_volumes(a, b, c) / 6.0, Vec3::Zero(), a, b, c);
  }
  return moments;
}

}  // namespace

MassProperties mass_properties(const Mesh& mesh) {
  const Box3 box = bounding_box(mesh);
  const Vec3 origin = box.isEmpty() ? Vec3::Zero() : Vec3(box.center());
  const Moments m =
      mesh.has_tetrahedra() ? integrate_tetrahedra(mesh, origin) : integrate_surface(mesh, origin);
  if (!(std::isfinite(m.volume) && m.volume > 0.0))
    throw InvalidArgument("mesh volume", fmt::format("{}", m.volume),
                          "must be positive and finite: the surface must be closed with its "
                          "triangles counter-clockwise from outside");
  MassProperties properties;
  properties.volume = m.volume;
  const Vec3 center = m.first / m.volume;
  properties.center_of_mass = origin + center;
  const Mat3 central = m.second - m.volume * center * center.transpose();
  properties.inertia = central.trace() * Mat3::Identity() - central;
  return properties;
}

PrincipalAxes principal_axes(const Mat3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
  Mat3 axes = solver.eigenvectors();
  // Eigenvectors are free to point either way: the largest component shall be positive.
  for (int k = 0; k < 2; ++k) {
    Eigen::Index largest = 0;
    axes.col(k).cwiseAbs().maxCoeff(&largest);
    if (axes(largest, k) < 0.0) axes.col(k) = -axes.col(k);
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return {solver.eigenvalues(), Quat(axes).normalized()};
}

}  // namespace gotai::geometry
