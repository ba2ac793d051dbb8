#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "gotai/voxel/run_order.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::voxel {
namespace {

// Orders [begin, end) of indices into points.
void order_range(const std::vector<Vec3>& points, std::uint32_t* begin, std::uint32_t* end) {
  const std::ptrdiff_t count = end - begin;
  if (count <= kLanes) {
    std::sort(begin, end);
    return;
  }
  std::ptrdiff_t unit = kLanes;
  while (unit * kLanes < count) unit *= kLanes;
  const std::ptrdiff_t units = (count + unit - 1) / unit;
  const std::ptrdiff_t middle = (units / 2) * unit;
  Box3 box;
  for (const std::uint32_t* i = begin; i != end; ++i) box.extend(points[*i]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  std::nth_element(begin, begin + middle, end, [&](std::uint32_t i, std::uint32_t j) {
    const double x = points[i][axis];
    const double y = points[j][axis];
    return x < y || (x == y && i < j);
  });
  order_range(points, begin, begin + middle);
  order_range(points, begin + middle, end);
}

struct Sphere {
  Eigen::Vector3f center;
  float radius;
};

// Smallest enclosing ball, nearly [Badoiu and Clarkson 2003, "Smaller core-sets for balls"]; the
// radius is then measured from the rounded centre and rounded up, so that it always contains.
Sphere bound(std::span<const Vec3> points) {
  Vec3 center = Vec3::Zero();
  for (const Vec3& p : points) center += p;
  center /= static_cast<double>(points.size());
  for (int step = 1; step <= 64; ++step) {
    const Vec3* far = &points[0];
    for (const Vec3& p : points) {
      if ((p - center).squaredNorm() > (*far - center).squaredNorm()) far = &p;
    }
    center += (*far - center) / (step + 1.0);
  }
  const Eigen::Vector3f rounded = center.cast<float>();
  double squared = 0.0;
  for (const Vec3& p : points) {
    squared = std::max(squared, (p - rounded.cast<double>()).squaredNorm());
  }
  return {rounded, static_cast<float>(std::sqrt(squared) * (1.0 + 1e-6))};
}

std::array<float, 3> to_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// One height: lane l of packet p bounds the samples [(8p + l) run, (8p + l + 1) run).
std::vector<SpherePacket> bound_runs(const std::vector<Vec3>& points, std::size_t run) {
  const std::size_t children = (points.size() + run - 1) / run;
  SpherePacket empty;
  empty.x.fill(0.0F);
  empty.y.fill(0.0F);
  empty.z.fill(0.0F);
  empty.radius.fill(-1.0F);
  std::vector<SpherePacket> packets((children + kLanes - 1) / kLanes, empty);
  for (std::size_t c = 0; c < children; ++c) {
    const std::size_t first = c * run;
    const std::size_t last = std::min(points.size(), first + run);
    const Sphere s = bound(std::span(points).subspan(first, last - first));
    SpherePacket& packet = packets[c / kLanes];
    const std::size_t lane = c % kLanes;
    packet.x[lane] = s.center.x();
    packet.y[lane] = s.center.y();
    packet.z[lane] = s.center.z();
    packet.radius[lane] = s.radius;
  }
  return packets;
}

}  // namespace

std::vector<std::uint32_t> order_in_runs(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  order_range(points, order.data(), order.data() + order.size());
  return order;
}

std::size_t SurfaceTree::bytes() const {
  std::size_t total = points.size() * sizeof(PointPacket);
  for (const auto& packets : heights) total += packets.size() * sizeof(SpherePacket);
  total += normal.size() * sizeof(normal[0]) + cone_cosine.size() * sizeof(float) +
           vector_area.size() * sizeof(vector_area[0]) + kind.size() +
           edge.size() * sizeof(edge[0]) + edge_direction.size() * sizeof(edge_direction[0]) +
           edge_reach.size() * sizeof(edge_reach[0]) + vertex.size() * sizeof(vertex[0]) +
           first_vertex.size() * sizeof(first_vertex[0]);
  return total;
}

SurfaceTree make_surface_tree(const std::vector<SurfaceSample>& samples, const Vec3& center) {
  std::vector<Vec3> positions;
  positions.reserve(samples.size());
  for (const SurfaceSample& s : samples) positions.push_back(s.position);
  const std::vector<std::uint32_t> order = order_in_runs(positions);

  SurfaceTree tree;
  // Bounds are taken over the rounded points, which are what a search transforms.
  std::vector<Vec3> points(samples.size());
  tree.points.resize((samples.size() + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < kLanes * tree.points.size(); ++i) {
    const std::size_t from = std::min(i, samples.size() - 1);
    const std::array<float, 3> x = to_floats(samples[order[from]].position - center);
    tree.points[i / kLanes].x[i % kLanes] = x[0];
    tree.points[i / kLanes].y[i % kLanes] = x[1];
    tree.points[i / kLanes].z[i % kLanes] = x[2];
    if (i < samples.size()) points[i] = Vec3(x[0], x[1], x[2]);
  }
  for (const std::uint32_t i : order) {
    const SurfaceSample& s = samples[i];
    tree.normal.push_back(to_floats(s.normal));
    tree.cone_cosine.push_back(static_cast<float>(s.cone_cosine));
    tree.vector_area.push_back(to_floats(s.vector_area));
    tree.kind.push_back(s.kind);
    tree.edge.push_back(-1);
    if (s.kind == SampleKind::edge) {
      tree.edge.back() = static_cast<std::int32_t>(tree.edge_direction.size());
      tree.edge_direction.push_back(to_floats(s.edge_direction));
      tree.edge_reach.push_back(
          {static_cast<float>(s.reach_back), static_cast<float>(s.reach_forward)});
    }
    tree.first_vertex.push_back(static_cast<std::uint32_t>(tree.vertex.size()));
    for (const Vec3& x : s.vertices) tree.vertex.push_back(to_floats(x - center));
  }
  tree.first_vertex.push_back(static_cast<std::uint32_t>(tree.vertex.size()));
  std::size_t run = kLanes;
  do {
    tree.heights.push_back(bound_runs(points, run));
    run *= kLanes;
  } while (tree.heights.back().size() > 1);
  return tree;
}

}  // namespace gotai::voxel
