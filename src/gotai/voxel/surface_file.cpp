#include "gotai/voxel/surface_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

namespace gotai::voxel {
namespace {

bool all_finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
}

template <typename T>
bool all_finite(const std::vector<T>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const T& row) { return all_finite(row); });
}

bool is_finite(const SurfaceTree& tree) {
  const auto is_finite_packet = [](const auto& p) {
    return all_finite(p.x) && all_finite(p.y) && all_finite(p.z);
  };
  for (const auto& packets : tree.heights) {
    if (!std::all_of(packets.begin(), packets.end(), is_finite_packet)) return false;
  }
  return std::all_of(tree.points.begin(), tree.points.end(), is_finite_packet) &&
         std::all_of(tree.elements.begin(), tree.elements.end(),
                     [](const SurfaceElement& e) { return std::isfinite(e.cone_cosine); }) &&
         std::all_of(tree.edges.begin(), tree.edges.end(),
                     [](const SampleEdge& e) {
                       return all_finite(e.direction) && std::isfinite(e.back) &&
                              std::isfinite(e.forward);
                     }) &&
         std::isfinite(tree.area_unit) && all_finite(tree.vertices);
}

// A search visits packet p of each height below lane p of the next.
bool has_right_sizes(const SurfaceTree& tree) {
  const std::size_t n = tree.size();
  if (n == 0 || tree.points.size() != (n + kLanes - 1) / kLanes || tree.heights.empty()) {
    return false;
  }
  std::size_t children = tree.points.size();
  for (const std::vector<SpherePacket>& packets : tree.heights) {
    if (packets.size() != (children + kLanes - 1) / kLanes) return false;
    for (std::size_t c = 0; c < kLanes * packets.size(); ++c) {
      const float radius = packets[c / kLanes].radius[c % kLanes];
      if (!(c < children ? radius >= 0.0F && std::isfinite(radius) : radius < 0.0F)) return false;
    }
    children = packets.size();
  }
  return children == 1;
}

// Edges belong to as many samples, vertices to samples in their order.
bool has_right_links(const SurfaceTree& tree, const std::vector<std::uint8_t>& on_edge,
                     const std::vector<std::uint32_t>& vertex_samples) {
  if (on_edge.size() != tree.points.size() || vertex_samples.size() != tree.vertices.size()) {
    return false;
  }
  const std::size_t beyond = tree.size() % kLanes;
  if (beyond != 0 && on_edge.back() >> beyond != 0) return false;
  std::size_t edges = 0;
  for (const std::uint8_t lanes : on_edge) edges += static_cast<std::size_t>(std::popcount(lanes));
  return edges == tree.edges.size() &&
         std::is_sorted(vertex_samples.begin(), vertex_samples.end()) &&
         (vertex_samples.empty() || vertex_samples.back() < tree.size());
}

bool is_possible(const DistanceField& field) {
  constexpr std::int32_t kMostBricks = (1 << kMaxSurfaceLevel) / kBrickCells + 2;
  if (field.bricks < 1 || field.bricks > kMostBricks || field.values.empty() ||
      field.values.size() % kBrickBytes != 0) {
    return false;
  }
  const auto n = static_cast<std::size_t>(field.bricks);
  const auto m = static_cast<std::size_t>(field.coarse_nodes());
  if (field.brick.size() != n * n * n || field.coarse.size() != m * m * m + 1) return false;
  const auto stored = static_cast<std::int32_t>(field.values.size() / kBrickBytes);
  if (!std::all_of(field.brick.begin(), field.brick.end(),
                   [&](std::int32_t b) { return b >= kNoBrickInside && b < stored; })) {
    return false;
  }
  for (const float x : {field.cell, field.scale, field.coarse_scale, field.band, field.trusted,
                        field.nearest_coarse, field.slope}) {
    if (!std::isfinite(x) || !(x > 0.0F)) return false;
  }
  return std::isfinite(field.low);
}

void encode_tree(ByteWriter& out, const SurfaceTree& tree) {
  out.array(tree.points);
  out.value(static_cast<std::uint32_t>(tree.heights.size()));
  for (const auto& packets : tree.heights) out.array(packets);
  out.array(tree.elements);
  out.value(tree.area_unit);
  std::vector<std::uint8_t> on_edge;
  for (std::size_t p = 0; p < tree.points.size(); ++p) on_edge.push_back(tree.links[p].on_edge);
  out.array(on_edge);
  out.array(tree.edges);
  out.array(tree.vertices);
  std::vector<std::uint32_t> vertex_samples;
  for (std::uint32_t i = 0; i < tree.size(); ++i) {
    vertex_samples.insert(vertex_samples.end(), tree.vertices_of(i).size(), i);
  }
  out.array(vertex_samples);
}

SurfaceTree decode_tree(ByteReader& in) {
  SurfaceTree tree;
  tree.points = in.array<PointPacket>();
  const auto heights = in.value<std::uint32_t>();
  if (heights > 16) in.fail("is damaged: the sample tree is too high");
  for (std::uint32_t h = 0; h < heights; ++h) tree.heights.push_back(in.array<SpherePacket>());
  tree.elements = in.array<SurfaceElement>();
  tree.area_unit = in.value<float>();
  const auto on_edge = in.array<std::uint8_t>();
  tree.edges = in.array<SampleEdge>();
  tree.vertices = in.array<std::array<float, 3>>();
  const auto vertex_samples = in.array<std::uint32_t>();
  if (!has_right_sizes(tree) || !has_right_links(tree, on_edge, vertex_samples) ||
      !is_finite(tree)) {
    in.fail("is damaged: impossible sample tree");
  }
  link_packets(tree, on_edge, vertex_samples);
  return tree;
}

void encode_field(ByteWriter& out, const DistanceField& field) {
  for (const float x : {field.low, field.cell, field.scale, field.coarse_scale, field.band,
                        field.trusted, field.nearest_coarse, field.slope}) {
    out.value(x);
  }
  out.value(field.bricks);
  out.array(field.brick);
  out.array(field.values);
  out.array(field.coarse);
}

DistanceField decode_field(ByteReader& in) {
  DistanceField field;
  for (float* x : {&field.low, &field.cell, &field.scale, &field.coarse_scale, &field.band,
                   &field.trusted, &field.nearest_coarse, &field.slope}) {
    *x = in.value<float>();
  }
  field.bricks = in.value<std::int32_t>();
  field.brick = in.array<std::int32_t>();
  field.values = in.array<std::uint8_t>();
  field.coarse = in.array<std::int16_t>();
  if (!is_possible(field)) in.fail("is damaged: impossible distance field");
  return field;
}

}  // namespace

void encode_surface(ByteWriter& out, const SurfaceModel& model) {
  out.value(static_cast<std::int32_t>(model.level));
  if (model.empty()) return;
  out.value(model.center);
  out.value(model.edge);
  out.value(model.spacing);
  out.value(model.area);
  encode_tree(out, model.tree);
  encode_field(out, model.field);
}

SurfaceModel decode_surface(ByteReader& in) {
  SurfaceModel model;
  model.level = in.value<std::int32_t>();
  if (model.empty()) return model;
  if (model.level < kMinSurfaceLevel || model.level > kMaxSurfaceLevel) {
    in.fail("is damaged: impossible surface level");
  }
  model.center = in.value<Vec3>();
  model.edge = in.value<double>();
  model.spacing = in.value<double>();
  model.area = in.value<double>();
  if (!model.center.allFinite() || !std::isfinite(model.edge) || !(model.edge > 0.0) ||
      !std::isfinite(model.spacing) || !(model.spacing > 0.0) || !std::isfinite(model.area)) {
    in.fail("is damaged: impossible surface model");
  }
  model.tree = decode_tree(in);
  model.field = decode_field(in);
  return model;
}

}  // namespace gotai::voxel
