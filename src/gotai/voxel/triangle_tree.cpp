#include "gotai/voxel/triangle_tree.h"

#include <algorithm>
#include <limits>

#include "gotai/voxel/run_order.h"

namespace gotai::voxel {
namespace {

using Box3f = Eigen::AlignedBox<float, 3>;

// The boxes of the packets below a height, eight to a packet.
std::vector<BoxPacket> gather_boxes(const std::vector<Box3f>& boxes) {
  constexpr float kNever = std::numeric_limits<float>::infinity();
  BoxPacket empty;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    empty.low[axis].fill(kNever);
    empty.high[axis].fill(-kNever);
  }
  std::vector<BoxPacket> packets((boxes.size() + kLanes - 1) / kLanes, empty);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      packets[i / kLanes].low[axis][i % kLanes] = boxes[i].min()[static_cast<int>(axis)];
      packets[i / kLanes].high[axis][i % kLanes] = boxes[i].max()[static_cast<int>(axis)];
    }
  }
  return packets;
}

// One box for every eight.
std::vector<Box3f> unite(const std::vector<Box3f>& boxes) {
  std::vector<Box3f> united((boxes.size() + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < boxes.size(); ++i) united[i / kLanes].extend(boxes[i]);
  return united;
}

}  // namespace

TriangleTree make_triangle_tree(const SignedDistance& surface, const Vec3& center) {
  std::vector<std::uint32_t> triangles;
  std::vector<Vec3> middles;
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    if (surface.face_normal(t).isZero()) continue;
    const auto [a, b, c] = surface.corners(t);
    triangles.push_back(t);
    middles.push_back((surface.vertex(a) + surface.vertex(b) + surface.vertex(c)) / 3.0);
  }
  const std::vector<std::uint32_t> order = order_in_runs(middles);

  TriangleTree tree;
  tree.center = center;
  tree.triangles.resize((order.size() + kLanes - 1) / kLanes);
  std::vector<Box3f> boxes(tree.triangles.size());
  for (std::size_t i = 0; i < kLanes * tree.triangles.size(); ++i) {
    const std::uint32_t t = triangles[order[std::min(i, order.size() - 1)]];
    const auto [a, b, c] = surface.corners(t);
    const Eigen::Vector3f p = (surface.vertex(a) - center).cast<float>();
    const Eigen::Vector3f q = (surface.vertex(b) - center).cast<float>();
    const Eigen::Vector3f r = (surface.vertex(c) - center).cast<float>();
    TrianglePacket& packet = tree.triangles[i / kLanes];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<int>(axis);
      packet.corner[axis][i % kLanes] = p[k];
      packet.edge_1[axis][i % kLanes] = q[k] - p[k];
      packet.edge_2[axis][i % kLanes] = r[k] - p[k];
    }
    packet.triangle[i % kLanes] = t;
    boxes[i / kLanes].extend(p).extend(q).extend(r);
  }
  do {
    tree.heights.push_back(gather_boxes(boxes));
    boxes = unite(boxes);
  } while (tree.heights.back().size() > 1);
  return tree;
}

}  // namespace gotai::voxel
