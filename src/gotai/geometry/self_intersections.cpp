#include "gotai/geometry/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "gotai/geometry/predicates.h"
#include "gotai/geometry/triangle_pair.h"

namespace gotai::geometry {

namespace {

/// Brings the mesh to a size around 1 by a power of two, which is exact, so that products of three
/// coordinates stay in range.
std::vector<Vec3> normalised(const Mesh& mesh) {
  double largest = 0.0;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      largest = std::max(largest, mesh.vertices[v].cwiseAbs().maxCoeff());
  std::vector<Vec3> vertices = mesh.vertices;
  if (largest == 0.0) return vertices;
  const int exponent = -std::ilogb(largest);
  for (Vec3& v : vertices)
    for (double& x : v) x = std::ldexp(x, exponent);
  return vertices;
}

/// Exactly without area: its shadow on every coordinate plane is flat.
bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto flat = [axis](const Vec3& p) { return Vec2(p[(axis + 1) % 3], p[(axis + 2) % 3]); };
    if (detail::orientation(flat(a), flat(b), flat(c)) != 0) return false;
  }
  return true;
}

/// Binary tree over boxes, split at the median of the longest axis.
class Tree {
 public:
  explicit Tree(std::vector<Box3> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    if (!order_.empty()) build(0, order_.size());
  }

  /// Calls visit(i, j) for every pair of overlapping boxes, i != j, until it returns false.
  template <typename Visit>
  void overlapping_pairs(const Visit& visit) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> tasks;
    if (!nodes_.empty()) tasks.emplace_back(0U, 0U);
    while (!tasks.empty()) {
      const auto [a, b] = tasks.back();
      tasks.pop_back();
      if (a != b && !nodes_[a].box.intersects(nodes_[b].box)) continue;
      if (!descend(a, b, tasks) && !compare(nodes_[a], nodes_[b], visit)) return;
    }
  }

 private:
  static constexpr std::size_t kLeaf = 4;
  struct Node {
    Box3 box;
    std::uint32_t begin;
    std::uint32_t end;
    std::uint32_t left = 0;  // 0 for leaves
    std::uint32_t right = 0;
  };

  std::uint32_t build(std::size_t begin, std::size_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node{Box3(), static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    for (std::size_t i = begin; i < end; ++i) node.box.extend(boxes_[order_[i]]);
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return index;
    Eigen::Index axis = 0;
    node.box.sizes().maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) {
      return order_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t i, std::uint32_t j) {
      const double x = boxes_[i].center()[axis];
      const double y = boxes_[j].center()[axis];
      return x != y ? x < y : i < j;
    });
    const std::uint32_t left = build(begin, middle);
    const std::uint32_t right = build(middle, end);
    nodes_[index].left = left;
    nodes_[index].right = right;
    return index;
  }

  /// Replaces a pair of nodes by pairs of their children; false for two leaves.
  bool descend(std::uint32_t a, std::uint32_t b,
               std::vector<std::pair<std::uint32_t, std::uint32_t>>& tasks) const {
    const Node& m = nodes_[a];
    const Node& n = nodes_[b];
    if (a == b) {
      if (m.left == 0) return false;
      tasks.insert(tasks.end(), {{m.left, m.left}, {m.right, m.right}, {m.left, m.right}});
      return true;
    }
    if (m.left == 0 && n.left == 0) return false;
    if (n.left == 0 || (m.left != 0 && m.end - m.begin >= n.end - n.begin))
      tasks.insert(tasks.end(), {{m.left, b}, {m.right, b}});
    else
      tasks.insert(tasks.end(), {{a, n.left}, {a, n.right}});
    return true;
  }

  template <typename Visit>
  bool compare(const Node& m, const Node& n, const Visit& visit) const {
    for (std::uint32_t i = m.begin; i < m.end; ++i)
      for (std::uint32_t j = m.begin == n.begin ? i + 1 : n.begin; j < n.end; ++j)
        if (boxes_[order_[i]].intersects(boxes_[order_[j]]) && !visit(order_[i], order_[j]))
          return false;
    return true;
  }

  std::vector<Box3> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

bool share_all(const Triangle& s, const Triangle& t) {
  return std::ranges::all_of(s,
                             [&t](std::uint32_t v) { return std::ranges::find(t, v) != t.end(); });
}

}  // namespace

SelfIntersections find_self_intersections(const Mesh& mesh, std::size_t most_candidates) {
  const std::vector<Vec3> vertices = normalised(mesh);
  std::vector<Triangle> triangles;
  std::vector<Box3> boxes;
  for (const Triangle& t : mesh.triangles) {
    if (is_degenerate(vertices[t[0]], vertices[t[1]], vertices[t[2]])) continue;
    triangles.push_back(t);
    Box3 box(vertices[t[0]]);
    box.extend(vertices[t[1]]);
    box.extend(vertices[t[2]]);
    boxes.push_back(box);
  }
  if (most_candidates == 0) most_candidates = 1'000'000 + 40 * triangles.size();
  SelfIntersections found;
  std::size_t candidates = 0;
  const Tree tree(std::move(boxes));
  tree.overlapping_pairs([&](std::uint32_t i, std::uint32_t j) {
    if (candidates++ == most_candidates) {
      found.complete = false;
      return false;
    }
    if (share_all(triangles[i], triangles[j]) ||
        detail::triangles_intersect(vertices, triangles[i], triangles[j]))
      ++found.pairs;
    return true;
  });
  return found;
}

}  // namespace gotai::geometry
