#include "gotai/voxel/winding_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gotai::voxel {
namespace {

constexpr std::uint32_t kLeafSize = 8;
/// A cluster is far beyond this many radii. Barill et al. 2018 use 2, with errors of 0.03 here.
constexpr double kFar = 3.0;
constexpr double kFullTurn = 4.0 * std::numbers::pi;

/// Solid angle of a triangle seen from the origin [Van Oosterom and Strackee 1983].
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// Whether the ray from + t direction, t > 0, meets a triangle [Moeller and Trumbore 1997].
bool ray_hits(const Vec3& from, const Vec3& direction, const Vec3& a, const Vec3& b,
              const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 across = direction.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0.0) return false;
  const Vec3 to = from - a;
  const double u = to.dot(across) / determinant;
  if (u < 0.0 || u > 1.0) return false;
  const Vec3 normal = to.cross(ab);
  const double v = direction.dot(normal) / determinant;
  return v >= 0.0 && u + v <= 1.0 && ac.dot(normal) / determinant > 0.0;
}

/// Whether the ray meets a box.
bool ray_meets_box(const Vec3& from, const Vec3& inverse_direction, const Vec3& low,
                   const Vec3& high) {
  const Vec3 t0 = (low - from).cwiseProduct(inverse_direction);
  const Vec3 t1 = (high - from).cwiseProduct(inverse_direction);
  const double enter = t0.cwiseMin(t1).maxCoeff();
  const double leave = t0.cwiseMax(t1).minCoeff();
  return leave >= std::max(enter, 0.0);
}

}  // namespace

WindingTree::WindingTree(const geometry::Mesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [i, j, k] = mesh.triangles[t];
    const Corners corners{mesh.vertices[i], mesh.vertices[j], mesh.vertices[k], t};
    if ((corners.b - corners.a).cross(corners.c - corners.a).squaredNorm() > 0.0)
      triangles_.push_back(corners);
  }
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t WindingTree::build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  Box3 box;
  Vec3 weighted = Vec3::Zero();
  double area = 0.0;
  node.area_vector.setZero();
  const auto vector_of = [](const Corners& t) { return Vec3(0.5 * (t.b - t.a).cross(t.c - t.a)); };
  for (std::uint32_t i = begin; i < end; ++i) {
    const Corners& t = triangles_[i];
    box.extend(t.a).extend(t.b).extend(t.c);
    const Vec3 vector = vector_of(t);
    node.area_vector += vector;
    area += vector.norm();
    weighted += vector.norm() / 3.0 * (t.a + t.b + t.c);
  }
  node.low = box.min();
  node.high = box.max();
  node.center = area > 0.0 ? Vec3(weighted / area) : Vec3(box.center());
  node.moment.setZero();
  double radius_squared = 0.0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Corners& t = triangles_[i];
    node.moment += ((t.a + t.b + t.c) / 3.0 - node.center) * vector_of(t).transpose();
    for (const Vec3& v : {t.a, t.b, t.c})
      radius_squared = std::max(radius_squared, (v - node.center).squaredNorm());
  }
  node.far_squared = kFar * kFar * radius_squared;
  if (end - begin <= kLeafSize) {
    node.first = begin;
    node.count = end - begin;
    nodes_[index] = node;
    return index;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle,
                   triangles_.begin() + end, [axis](const Corners& s, const Corners& t) {
                     const double x = s.a[axis] + s.b[axis] + s.c[axis];
                     const double y = t.a[axis] + t.b[axis] + t.c[axis];
                     return x < y || (x == y && s.triangle < t.triangle);
                   });
  build(begin, middle);
  node.first = build(middle, end);
  nodes_[index] = node;
  return index;
}

double WindingTree::winding_number(const Vec3& x) const {
  if (nodes_.empty()) return 0.0;
  double angle = 0.0;
  std::array<std::uint32_t, 64> stack;  // the tree is balanced: depth <= 32
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    const Vec3 r = node.center - x;
    const double squared = r.squaredNorm();
    if (squared > node.far_squared) {
      // n . G + M : grad G with G = r / |r|^3.
      const double inverse_cube = 1.0 / (squared * std::sqrt(squared));
      angle += inverse_cube * (node.area_vector.dot(r) + node.moment.trace() -
                               3.0 * r.dot(node.moment * r) / squared);
    } else if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Corners& t = triangles_[i];
        angle += solid_angle(t.a - x, t.b - x, t.c - x);
      }
    } else {
      stack[size++] = node.first;
      stack[size++] = index + 1;
    }
  }
  return angle / kFullTurn;
}

double WindingTree::exact_winding_number(const Vec3& x) const {
  double angle = 0.0;
  for (const Corners& t : triangles_) angle += solid_angle(t.a - x, t.b - x, t.c - x);
  return angle / kFullTurn;
}

int WindingTree::count_hits(const Vec3& from, const Vec3& direction, std::uint32_t except) const {
  if (nodes_.empty()) return 0;
  const Vec3 inverse = direction.cwiseInverse();
  int hits = 0;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    if (!ray_meets_box(from, inverse, node.low, node.high)) continue;
    if (node.count == 0) {
      stack[size++] = node.first;
      stack[size++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Corners& t = triangles_[i];
      if (t.triangle != except && ray_hits(from, direction, t.a, t.b, t.c)) ++hits;
    }
  }
  return hits;
}

}  // namespace gotai::voxel
