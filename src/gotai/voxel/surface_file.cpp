#include "gotai/voxel/surface_file.h"

#include <algorithm>
#include <cmath>

namespace gotai::voxel {
namespace {

template <typename T>
bool all_finite(const std::vector<T>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const T& row) {
    return std::all_of(row.begin(), row.end(), [](float x) { return std::isfinite(x); });
  });
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
}

// A search visits packet p of each height below lane p of the next.
bool has_right_sizes(const SurfaceTree& tree) {
  const std::size_t n = tree.size();
  if (n == 0 || tree.vector_area.size() != n || tree.cone_cosine.size() != n ||
      tree.kind.size() != n || tree.edge.size() != n ||
      tree.edge_reach.size() != tree.edge_direction.size() || tree.first_vertex.size() != n + 1 ||
      tree.points.size() != (n + kLanes - 1) / kLanes || tree.heights.empty()) {
    return false;
  }
  if (!std::is_sorted(tree.first_vertex.begin(), tree.first_vertex.end()) ||
      tree.first_vertex.front() != 0 || tree.first_vertex.back() != tree.vertex.size()) {
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

bool is_possible(const SurfaceTree& tree) {
  const auto edges = static_cast<std::int32_t>(tree.edge_direction.size());
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (tree.kind[i] > SampleKind::corner) return false;
    const bool is_edge = tree.kind[i] == SampleKind::edge;
    if (is_edge ? tree.edge[i] < 0 || tree.edge[i] >= edges : tree.edge[i] != -1) return false;
  }
  const auto finite = [](const auto& p) {
    return std::all_of(p.x.begin(), p.x.end(), [](float v) { return std::isfinite(v); }) &&
           std::all_of(p.y.begin(), p.y.end(), [](float v) { return std::isfinite(v); }) &&
           std::all_of(p.z.begin(), p.z.end(), [](float v) { return std::isfinite(v); });
  };
  for (const auto& packets : tree.heights) {
    if (!std::all_of(packets.begin(), packets.end(), finite)) return false;
  }
  return std::all_of(tree.points.begin(), tree.points.end(), finite) && all_finite(tree.normal) &&
         all_finite(tree.cone_cosine) && all_finite(tree.vector_area) &&
         all_finite(tree.edge_direction) && all_finite(tree.edge_reach) && all_finite(tree.vertex);
}

bool is_possible(const DistanceField& field) {
  constexpr std::int32_t kMostBricks = (1 << kMaxSurfaceLevel) / kBrickCells + 2;
  if (field.bricks < 1 || field.bricks > kMostBricks || field.values.size() % kBrickStride != 0) {
    return false;
  }
  const auto n = static_cast<std::size_t>(field.bricks);
  const auto m = static_cast<std::size_t>(field.coarse_nodes());
  if (field.brick.size() != n * n * n || field.coarse.size() != m * m * m + 1) return false;
  const auto stored = static_cast<std::int32_t>(field.values.size() / kBrickStride);
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
  out.array(tree.normal);
  out.array(tree.cone_cosine);
  out.array(tree.vector_area);
  out.array(tree.kind);
  out.array(tree.edge_direction);
  out.array(tree.edge_reach);
  out.array(tree.edge);
  out.array(tree.vertex);
  out.array(tree.first_vertex);
}

SurfaceTree decode_tree(ByteReader& in) {
  SurfaceTree tree;
  tree.points = in.array<PointPacket>();
  const auto heights = in.value<std::uint32_t>();
  if (heights > 16) in.fail("is damaged: the sample tree is too high");
  for (std::uint32_t h = 0; h < heights; ++h) tree.heights.push_back(in.array<SpherePacket>());
  tree.normal = in.array<std::array<float, 3>>();
  tree.cone_cosine = in.array<float>();
  tree.vector_area = in.array<std::array<float, 3>>();
  tree.kind = in.array<SampleKind>();
  tree.edge_direction = in.array<std::array<float, 3>>();
  tree.edge_reach = in.array<std::array<float, 2>>();
  tree.edge = in.array<std::int32_t>();
  tree.vertex = in.array<std::array<float, 3>>();
  tree.first_vertex = in.array<std::uint32_t>();
  if (!has_right_sizes(tree) || !is_possible(tree)) in.fail("is damaged: impossible sample tree");
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
  field.values = in.array<std::int16_t>();
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
