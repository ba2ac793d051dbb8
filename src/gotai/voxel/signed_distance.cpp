#include "gotai/voxel/signed_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>

#include "gotai/core/error.h"

namespace gotai::voxel {
namespace {

constexpr std::uint32_t kLeafSize = 4;

// Which feature of a triangle is nearest: corner 0..2, edge 3..5 (edge e from corner e), face 6.
struct TrianglePoint {
  Vec3 point;
  int feature;
};

// Ericson 2005, "Real-Time Collision Detection", section 5.1.5.
TrianglePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + ab * (d1 / (d1 - d3)), 3};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + ac * (d2 / (d2 - d6)), 5};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), 4};
  }
  const double scale = 1.0 / (va + vb + vc);
  return {a + ab * (vb * scale) + ac * (vc * scale), 6};
}

double squared_distance_to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

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
  face_normal_.resize(triangles_.size());
  vertex_normal_.assign(vertices_.size(), Vec3::Zero());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const auto [a, b, c] = triangles_[t];
    const Vec3 n = (vertices_[b] - vertices_[a]).cross(vertices_[c] - vertices_[a]);
    const double length = n.norm();
    face_normal_[t] = length > 0.0 ? Vec3(n / length) : Vec3::Zero();
    if (!(length > 0.0)) continue;
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

std::uint32_t SignedDistance::build_node(std::vector<Vec3>& centers, std::uint32_t begin,
                                         std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Box3 box;
  Box3 center_box;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const std::uint32_t v : triangles_[order_[i]]) box.extend(vertices_[v]);
    center_box.extend(centers[order_[i]]);
  }
  nodes_[index].low = box.min();
  nodes_[index].high = box.max();
  if (end - begin <= kLeafSize) {
    nodes_[index].first = begin;
    nodes_[index].count = end - begin;
    return index;
  }
  Eigen::Index axis = 0;
  center_box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t i, std::uint32_t j) {
                     const double x = centers[i][axis];
                     const double y = centers[j][axis];
                     return x < y || (x == y && i < j);
                   });
  build_node(centers, begin, middle);
  nodes_[index].first = build_node(centers, middle, end);
  return index;
}

Vec3 SignedDistance::pseudonormal(std::uint32_t triangle, int feature) const {
  if (feature < 3) {
    return vertex_normal_[triangles_[triangle][static_cast<std::size_t>(feature)]].normalized();
  }
  if (feature < 6) {
    const std::uint32_t other = neighbor_[triangle][static_cast<std::size_t>(feature) - 3];
    if (other != kNoTriangle) {
      const Vec3 sum = face_normal_[triangle] + face_normal_[other];
      if (sum.squaredNorm() > 1e-20) return sum.normalized();
    }
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
    std::uint32_t node;
    double squared;
  };
  std::array<Entry, 64> stack;  // the tree is balanced: depth <= 32
  std::size_t size = 0;
  stack[size++] = {0, squared_distance_to_box(x, nodes_[0].low, nodes_[0].high)};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.squared > best) continue;
    const Node& node = nodes_[entry.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        consider(order_[i], corners_[i][0], corners_[i][1], corners_[i][2]);
      }
      continue;
    }
    const std::uint32_t left = entry.node + 1;
    const std::uint32_t right = node.first;
    const double to_left = squared_distance_to_box(x, nodes_[left].low, nodes_[left].high);
    const double to_right = squared_distance_to_box(x, nodes_[right].low, nodes_[right].high);
    const bool left_first = to_left <= to_right;
    stack[size++] = left_first ? Entry{right, to_right} : Entry{left, to_left};
    stack[size++] = left_first ? Entry{left, to_left} : Entry{right, to_right};
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

ClosestPoint SignedDistance::query_triangle(const Vec3& x, std::uint32_t triangle) const {
  const auto [a, b, c] = triangles_[triangle];
  const TrianglePoint nearest = closest_on_triangle(x, vertices_[a], vertices_[b], vertices_[c]);
  ClosestPoint result;
  result.point = nearest.point;
  result.triangle = triangle;
  result.pseudonormal = pseudonormal(triangle, nearest.feature);
  result.distance = (x - nearest.point).norm();
  if (is_inside(x, result)) result.distance = -result.distance;
  return result;
}

}  // namespace gotai::voxel
