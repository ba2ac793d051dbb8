#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

#include "gotai/core/bytes_of.h"
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
  return bytes_of(points) + bytes_of(heights) + bytes_of(elements) + bytes_of(edges) +
         bytes_of(vertices) + bytes_of(vertex_lane) + bytes_of(links);
}

std::span<const std::array<float, 3>> SurfaceTree::vertices_of(std::uint32_t sample) const {
  if (!has_vertices(sample)) return {};
  const std::uint32_t packet = sample / kLanes;
  const auto begin = vertex_lane.begin() + links[packet].first_vertex;
  const auto end = vertex_lane.begin() + links[packet + 1].first_vertex;
  const auto [first, last] =
      std::equal_range(begin, end, static_cast<std::uint8_t>(sample % kLanes));
  return std::span(vertices).subspan(static_cast<std::size_t>(first - vertex_lane.begin()),
                                     static_cast<std::size_t>(last - first));
}

void link_packets(SurfaceTree& tree, const std::vector<std::uint8_t>& on_edge,
                  const std::vector<std::uint32_t>& vertex_samples) {
  tree.links.assign(on_edge.size() + 1, {});
  for (std::size_t p = 0; p < on_edge.size(); ++p) {
    tree.links[p].on_edge = on_edge[p];
    tree.links[p + 1].first_edge =
        tree.links[p].first_edge + static_cast<std::uint32_t>(std::popcount(on_edge[p]));
  }
  tree.vertex_lane.reserve(vertex_samples.size());
  for (const std::uint32_t sample : vertex_samples) {
    const std::uint32_t lane = sample % kLanes;
    tree.vertex_lane.push_back(static_cast<std::uint8_t>(lane));
    PacketLinks& packet = tree.links[sample / kLanes];
    packet.has_vertices = static_cast<std::uint8_t>(packet.has_vertices | 1U << lane);
    tree.links[sample / kLanes + 1].first_vertex =
        static_cast<std::uint32_t>(tree.vertex_lane.size());
  }
  for (std::size_t p = 1; p < tree.links.size(); ++p) {
    tree.links[p].first_vertex =
        std::max(tree.links[p].first_vertex, tree.links[p - 1].first_vertex);
  }
}

namespace {

std::array<std::int16_t, 3> to_units(const Vec3& v, double unit) {
  const auto round = [unit](double x) { return static_cast<std::int16_t>(std::lround(x / unit)); };
  return {round(v.x()), round(v.y()), round(v.z())};
}

// What samples are besides points.
void append_elements(const std::vector<SurfaceSample>& samples,
                     const std::vector<std::uint32_t>& order, const Vec3& center,
                     SurfaceTree& tree) {
  double largest = 0.0;
  for (const SurfaceSample& s : samples) {
    largest = std::max(largest, s.vector_area.cwiseAbs().maxCoeff());
  }
  // Rounded up, so that the largest fits; a surface may cancel in every sample.
  tree.area_unit = largest > 0.0 ? static_cast<float>(largest / 32766.0) : 1.0F;
  std::vector<std::uint8_t> on_edge(tree.points.size());
  std::vector<std::uint32_t> vertex_samples;
  tree.elements.reserve(samples.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const SurfaceSample& s = samples[order[i]];
    tree.elements.push_back({to_units(s.normal, static_cast<double>(kNormalUnit)),
                             to_units(s.vector_area, static_cast<double>(tree.area_unit)),
                             static_cast<float>(s.cone_cosine)});
    if (s.kind == SampleKind::edge) {
      on_edge[i / kLanes] = static_cast<std::uint8_t>(on_edge[i / kLanes] | 1U << i % kLanes);
      tree.edges.push_back({to_floats(s.edge_direction), static_cast<float>(s.reach_back),
                            static_cast<float>(s.reach_forward)});
    }
    for (const Vec3& x : s.vertices) {
      tree.vertices.push_back(to_floats(x - center));
      vertex_samples.push_back(static_cast<std::uint32_t>(i));
    }
  }
  tree.edges.shrink_to_fit();
  tree.vertices.shrink_to_fit();
  link_packets(tree, on_edge, vertex_samples);
}

}  // namespace

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
  append_elements(samples, order, center, tree);
  std::size_t run = kLanes;
  do {
    tree.heights.push_back(bound_runs(points, run));
    run *= kLanes;
  } while (tree.heights.back().size() > 1);
  return tree;
}

}  // namespace gotai::voxel
