#include "gotai/collision/curved_samples.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "gotai/collision/surface_sample.h"

namespace gotai::collision {
namespace {

using voxel::SignedDistance;

// Edges of a smooth surface bend by less [rad]; the true surface is then within 1e-3 of its edges.
constexpr double kSmoothAngle = 0.09;
// Radii of curvature above this many extents are flat.
constexpr double kFlatRadius = 20.0;
// A sample stands for the surface within this many spacings.
constexpr double kReach = 1.5;

std::vector<Vec3> vertex_normals(const SignedDistance& surface) {
  std::vector<Vec3> normals(surface.vertex_count(), Vec3::Zero());
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    const geometry::Triangle& corner = surface.corners(t);
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 u = surface.vertex(corner[(e + 1) % 3]) - surface.vertex(corner[e]);
      const Vec3 v = surface.vertex(corner[(e + 2) % 3]) - surface.vertex(corner[e]);
      const double weight = u.squaredNorm() * v.squaredNorm();
      if (weight > 0.0) normals[corner[e]] += u.cross(v) / weight;
    }
  }
  for (Vec3& n : normals) n.normalize();
  return normals;
}

// Vertices all of whose edges bend by little.
std::vector<bool> smooth_vertices(const SignedDistance& surface) {
  std::vector<bool> smooth(surface.vertex_count(), true);
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    const geometry::Triangle& corner = surface.corners(t);
    for (int e = 0; e < 3; ++e) {
      const std::uint32_t other = surface.neighbor(t, e);
      const bool bends_little =
          other != SignedDistance::kNoTriangle &&
          surface.face_normal(t).dot(surface.face_normal(other)) > std::cos(kSmoothAngle);
      if (bends_little) continue;
      smooth[corner[static_cast<std::size_t>(e)]] = false;
      smooth[corner[static_cast<std::size_t>(e + 1) % 3]] = false;
    }
  }
  return smooth;
}

// How the normal turns across a triangle: dn = curvature dx, symmetric, zero along the face's
// normal.
Mat3 curvature_of(const SignedDistance& surface, std::uint32_t triangle,
                  const std::vector<Vec3>& normals) {
  const geometry::Triangle& corner = surface.corners(triangle);
  const Vec3& n = surface.face_normal(triangle);
  const Vec3 t1 = (surface.vertex(corner[1]) - surface.vertex(corner[0])).normalized();
  const Vec3 t2 = n.cross(t1);
  Mat3 gram = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (std::size_t e = 0; e < 3; ++e) {
    const std::size_t next = (e + 1) % 3;
    const Vec3 dx = surface.vertex(corner[next]) - surface.vertex(corner[e]);
    const Vec3 dn = normals[corner[next]] - normals[corner[e]];
    const Vec3 along_1(dx.dot(t1), dx.dot(t2), 0.0);
    const Vec3 along_2(0.0, dx.dot(t1), dx.dot(t2));
    gram += along_1 * along_1.transpose() + along_2 * along_2.transpose();
    right += dn.dot(t1) * along_1 + dn.dot(t2) * along_2;
  }
  const Vec3 k = gram.ldlt().solve(right);
  return k[0] * t1 * t1.transpose() + k[1] * (t1 * t2.transpose() + t2 * t1.transpose()) +
         k[2] * t2 * t2.transpose();
}

// Height of the smooth surface above a point of a triangle: none at the corners.
double bulge(const SignedDistance& surface, std::uint32_t triangle, const Vec3& weights,
             const Mat3& curvature) {
  const geometry::Triangle& corner = surface.corners(triangle);
  double height = 0.0;
  for (int e = 0; e < 3; ++e) {
    const int next = (e + 1) % 3;
    const Vec3 edge = surface.vertex(corner[static_cast<std::size_t>(next)]) -
                      surface.vertex(corner[static_cast<std::size_t>(e)]);
    height += 0.5 * weights[e] * weights[next] * edge.dot(curvature * edge);
  }
  return height;
}

Vec3 barycentric(const SignedDistance& surface, std::uint32_t triangle, const Vec3& x) {
  const geometry::Triangle& corner = surface.corners(triangle);
  const Vec3& n = surface.face_normal(triangle);
  Vec3 weights;
  for (int e = 0; e < 3; ++e) {
    const Vec3& a = surface.vertex(corner[static_cast<std::size_t>(e + 1) % 3]);
    const Vec3& b = surface.vertex(corner[static_cast<std::size_t>(e + 2) % 3]);
    weights[e] = std::max(0.0, (b - a).cross(x - a).dot(n));
  }
  return weights / weights.sum();
}

// How the surface bends around a point of a smooth triangle.
CurvedSample bend(const SignedDistance& surface, std::uint32_t triangle,
                  const std::vector<Vec3>& normals, const Vec3& x, const Vec3& center) {
  const geometry::Triangle& corner = surface.corners(triangle);
  const Mat3 curvature = curvature_of(surface, triangle, normals);
  const Vec3 weights = barycentric(surface, triangle, x);
  CurvedSample c;
  c.normal = (weights[0] * normals[corner[0]] + weights[1] * normals[corner[1]] +
              weights[2] * normals[corner[2]])
                 .normalized();
  c.point = x - center + bulge(surface, triangle, weights, curvature) * c.normal;
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = c.normal.unitOrthogonal();
  tangents.col(1) = c.normal.cross(tangents.col(0));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(tangents.transpose() * curvature *
                                                            tangents);
  for (int k = 0; k < 2; ++k) {
    c.direction[static_cast<std::size_t>(k)] = tangents * axes.eigenvectors().col(k);
  }
  c.curvature = axes.eigenvalues();
  return c;
}

}  // namespace

Eigen::Vector2d slide_to_face(const CurvedSample& sample, const Vec3& toward) {
  Eigen::Vector2d slide = Eigen::Vector2d::Zero();
  for (int k = 0; k < 2; ++k) {
    if (!(sample.curvature[k] > 0.0)) continue;
    slide[k] = toward.dot(sample.direction[static_cast<std::size_t>(k)]) / sample.curvature[k];
  }
  return slide;
}

Vec3 slid_point(const CurvedSample& sample, const Eigen::Vector2d& slide) {
  const Eigen::Vector2d across = sample.curvature.cwiseProduct(slide);
  const double along = std::sqrt(std::max(0.0, 1.0 - across.squaredNorm()));
  return sample.point + slide[0] * sample.direction[0] + slide[1] * sample.direction[1] -
         slide.dot(across) / (1.0 + along) * sample.normal;
}

CurvedSamples::CurvedSamples(const voxel::SurfaceModel& model, const SignedDistance& surface)
    : reach_(kReach * model.spacing) {
  const std::vector<bool> smooth = smooth_vertices(surface);
  if (std::ranges::find(smooth, true) == smooth.end()) return;
  const std::vector<Vec3> normals = vertex_normals(surface);
  const double flat = 1.0 / (kFlatRadius * model.edge);
  index_.assign(model.tree.size(), -1);
  std::uint32_t triangle = SignedDistance::kNoTriangle;
  for (std::uint32_t s = 0; s < model.tree.size(); ++s) {
    if (model.tree.edge_of(s) != nullptr) continue;
    const Vec3 x = sample_point(model, s);
    triangle = surface.query(x, std::numeric_limits<double>::infinity(), triangle).triangle;
    const geometry::Triangle& corner = surface.corners(triangle);
    if (!(smooth[corner[0]] && smooth[corner[1]] && smooth[corner[2]])) continue;
    CurvedSample c = bend(surface, triangle, normals, x, model.center);
    for (double& k : c.curvature) k = std::abs(k) < flat ? 0.0 : k;
    if (!(c.curvature.maxCoeff() > 0.0)) continue;
    index_[s] = static_cast<std::int32_t>(samples_.size());
    samples_.push_back(c);
  }
  if (samples_.empty()) index_ = std::vector<std::int32_t>();
  samples_.shrink_to_fit();
}

}  // namespace gotai::collision
