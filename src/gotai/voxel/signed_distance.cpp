#include "gotai/voxel/signed_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>

#include "gotai/core/error.h"
#include "gotai/voxel/triangle_point.h"

namespace gotai::voxel {
namespace {

constexpr std::uint32_t kLeafSize = 4;

double corner_angle(const Vec3& at, const Vec3& to_b, const Vec3& to_c) {
  const Vec3 u = to_b - at;
  const Vec3 v = to_c - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

bool less_position(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}  // namespace

SignedDistance::SignedDistance(const geometry::Mesh& mesh, const WindingTree* inside)
    : inside_(inside) {
  merge_vertices(mesh);
  find_normals();
  find_neighbors();
  build();
}

void SignedDistance::merge_vertices(const geometry::Mesh& mesh) {
  std::vector<std::uint32_t> sorted(mesh.vertices.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t i, std::uint32_t j) {
    return less_position(mesh.vertices[i], mesh.vertices[j]);
  });
  std::vector<std::uint32_t> merged(mesh.vertices.size());
  for (const std::uint32_t i : sorted) {
    if (vertices_.empty() || vertices_.back() != mesh.vertices[i]) {
      vertices_.push_back(mesh.vertices[i]);
    }
    merged[i] = static_cast<std::uint32_t>(vertices_.size() - 1);
  }
  triangles_.reserve(mesh.triangles.size());
  for (const geometry::Triangle& t : mesh.triangles) {
    triangles_.push_back({merged[t[0]], merged[t[1]], merged[t[2]]});
  }
}

void SignedDistance::find_normals() {
  face_normal_.reserve(triangles_.size());
  vertex_normal_.assign(vertices_.size(), Vec3::Zero());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const auto [a, b, c] = triangles_[t];
    face_normal_.push_back(triangle_normal(vertices_[a], vertices_[b], vertices_[c]));
    if (face_normal_[t].isZero()) continue;
    order_.push_back(t);
    const std::array<std::uint32_t, 3> corner = {a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
      vertex_normal_[corner[k]] +=
          corner_angle(vertices_[corner[k]], vertices_[corner[(k + 1) % 3]],
                       vertices_[corner[(k + 2) % 3]]) *
          face_normal_[t];
    }
  }
  if (order_.empty()) {
    throw InvalidArgument("mesh", std::to_string(triangles_.size()) + " triangles",
                          "the surface has no triangle with an area; check the file");
  }
}

void SignedDistance::find_neighbors() {
  struct Side {
    std::uint32_t low, high, triangle, edge;
    bool forward;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles_.size());
  for (const std::uint32_t t : order_) {
    for (std::uint32_t e = 0; e < 3; ++e) {
      const std::uint32_t i = triangles_[t][e];
      const std::uint32_t j = triangles_[t][(e + 1) % 3];
      sides.push_back({std::min(i, j), std::max(i, j), t, e, i < j});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tie(x.low, x.high, x.triangle, x.edge) <
           std::tie(y.low, y.high, y.triangle, y.edge);
  });
  neighbor_.assign(triangles_.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    if (end - i == 2 && sides[i].forward != sides[i + 1].forward) {
      neighbor_[sides[i].triangle][sides[i].edge] = sides[i + 1].triangle;
      neighbor_[sides[i + 1].triangle][sides[i + 1].edge] = sides[i].triangle;
    }
    i = end;
  }
}

void SignedDistance::build() {
  std::vector<Vec3> centers(triangles_.size());
  for (const std::uint32_t t : order_) {
    const auto [a, b, c] = triangles_[t];
    centers[t] = (vertices_[a] + vertices_[b] + vertices_[c]) / 3.0;
  }
  nodes_.reserve(order_.size());
  build_node(centers, 0, static_cast<std::uint32_t>(order_.size()));
  for (const std::uint32_t t : order_) {
    const auto [a, b, c] = triangles_[t];
    corners_.push_back({vertices_[a], vertices_[b], vertices_[c]});
  }
}

// A node of the triangles [begin, end) of order_.
void SignedDistance::build_node(std::vector<Vec3>& centers, std::uint32_t begin,
                                std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Box3 box;
  for (std::uint32_t i = begin; i < end; ++i) box.extend(centers[order_[i]]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t i, std::uint32_t j) {
                     const double x = centers[i][axis];
                     const double y = centers[j][axis];
                     return x < y || (x == y && i < j);
                   });
  // The only triangle of a surface is both children.
  build_child(centers, begin, std::max(middle, begin + 1), index, 0);
  build_child(centers, middle, end, index, 1);
}

void SignedDistance::build_child(std::vector<Vec3>& centers, std::uint32_t begin, std::uint32_t end,
                                 std::uint32_t node, std::size_t child) {
  Box3 box;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const std::uint32_t v : triangles_[order_[i]]) box.extend(vertices_[v]);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    const auto c = static_cast<Eigen::Index>(child);
    nodes_[node].low[axis][c] = box.min()[k];
    nodes_[node].high[axis][c] = box.max()[k];
  }
  const bool is_leaf = end - begin <= kLeafSize;
  nodes_[node].count[child] = is_leaf ? end - begin : 0;
  nodes_[node].first[child] = is_leaf ? begin : static_cast<std::uint32_t>(nodes_.size());
  if (!is_leaf) build_node(centers, begin, end);
}

Vec3 SignedDistance::pseudonormal(std::uint32_t triangle, int feature) const {
  if (feature < 3) {
    return vertex_normal_[triangles_[triangle][static_cast<std::size_t>(feature)]].normalized();
  }
  if (feature < 6) {
    const std::uint32_t other = neighbor_[triangle][static_cast<std::size_t>(feature) - 3];
    if (other != kNoTriangle) return edge_pseudonormal(face_normal_[triangle], face_normal_[other]);
  }
  return face_normal_[triangle];
}

ClosestPoint SignedDistance::query(const Vec3& x, double limit, std::uint32_t hint) const {
  double best = limit * limit;
  ClosestPoint result;
  int feature = -1;
  const auto consider = [&](std::uint32_t t, const Vec3& a, const Vec3& b, const Vec3& c) {
    const TrianglePoint candidate = closest_on_triangle(x, a, b, c);
    const double squared = (x - candidate.point).squaredNorm();
    if (squared < best || (squared == best && feature < 0)) {
      best = squared;
      result.point = candidate.point;
      result.triangle = t;
      feature = candidate.feature;
    }
  };
  if (hint != kNoTriangle) {
    const auto [a, b, c] = triangles_[hint];
    consider(hint, vertices_[a], vertices_[b], vertices_[c]);
  }
  struct Entry {
    double squared;
    std::uint32_t first, count;
  };
  // As far as the best itself only a first triangle is wanted.
  const auto may_hold_nearer = [&](double squared) {
    return squared < best || (squared == best && feature < 0);
  };
  std::array<Entry, 64> stack;  // the tree is balanced: depth <= 32
  std::size_t size = 0;
  stack[size++] = {0.0, 0, 0};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (!may_hold_nearer(entry.squared)) continue;
    for (std::uint32_t i = entry.first; i < entry.first + entry.count; ++i) {
      consider(order_[i], corners_[i][0], corners_[i][1], corners_[i][2]);
    }
    if (entry.count > 0) continue;
    const Node& node = nodes_[entry.first];
    Eigen::Array2d squared = Eigen::Array2d::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = x[static_cast<Eigen::Index>(axis)];
      squared += (node.low[axis] - at).max(at - node.high[axis]).max(0.0).square();
    }
    const std::size_t near = squared[0] <= squared[1] ? 0 : 1;
    for (const std::size_t child : {1 - near, near}) {
      const double to_child = squared[static_cast<Eigen::Index>(child)];
      if (may_hold_nearer(to_child))
        stack[size++] = {to_child, node.first[child], node.count[child]};
    }
  }
  if (feature < 0) return result;
  result.pseudonormal = pseudonormal(result.triangle, feature);
  result.distance = is_inside(x, result) ? -std::sqrt(best) : std::sqrt(best);
  return result;
}

bool SignedDistance::is_inside(const Vec3& x, const ClosestPoint& nearest) const {
  return inside_ != nullptr ? inside_->winding_number(x) > 0.5
                            : (x - nearest.point).dot(nearest.pseudonormal) < 0.0;
}

}  // namespace gotai::voxel
