#include "gotai/voxel/inside_soup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "gotai/core/parallel.h"
#include "gotai/voxel/center_lines.h"

namespace gotai::voxel {

double enclosure(const geometry::Mesh& mesh, const WindingTree& tree) {
  const double reach = 1e-6 * geometry::bounding_box(mesh).sizes().maxCoeff();
  // Every so many triangles are enough for a mean.
  constexpr std::size_t most = 4000;
  const std::size_t stride = (mesh.triangles.size() + most - 1) / most;
  if (stride == 0) return 0.0;
  const std::size_t samples = (mesh.triangles.size() + stride - 1) / stride;
  std::vector<double> area(samples, 0.0);
  std::vector<double> enclosed(samples, 0.0);
  parallel_for(samples, 64, [&](std::size_t s) {
    const auto [i, j, k] = mesh.triangles[s * stride];
    const Vec3& a = mesh.vertices[i];
    const Vec3& b = mesh.vertices[j];
    const Vec3& c = mesh.vertices[k];
    const Vec3 vector = 0.5 * (b - a).cross(c - a);
    area[s] = vector.norm();
    if (area[s] == 0.0) return;
    const Vec3 middle = (a + b + c) / 3.0;
    const Vec3 step = reach / area[s] * vector;
    // 1 on a closed surface, 3 where it lies inside another one, and so on.
    const double sum = tree.winding_number(middle + step) + tree.winding_number(middle - step);
    const double whole = std::max(1.0, 2.0 * std::round(0.5 * (sum - 1.0)) + 1.0);
    enclosed[s] = area[s] * std::max(0.0, 1.0 - std::abs(sum - whole));
  });
  double total_area = 0.0;
  double total = 0.0;
  for (std::size_t s = 0; s < samples; ++s) {
    total_area += area[s];
    total += enclosed[s];
  }
  return total_area > 0.0 ? total / total_area : 0.0;
}

double missing_share(const geometry::Mesh& mesh) {
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3& a = mesh.vertices[i];
    const Vec3 vector = 0.5 * (mesh.vertices[j] - a).cross(mesh.vertices[k] - a);
    sum += vector;
    area += vector.norm();
  }
  return area > 0.0 ? sum.norm() / area : 1.0;
}

namespace {

/// Voxels per side of the blocks that are decided at once where no surface is near.
constexpr int kBlock = 4;

/// Decides the voxels of one level by their winding numbers.
class WindingTest {
 public:
  WindingTest(const WindingTree& tree, const VoxelGrid& grid, int level)
      : tree_(tree), lines_(grid, level), blocks_((lines_.side() + kBlock - 1) / kBlock) {
    mark_blocks_near_surface();
  }

  int blocks() const { return blocks_; }

  /// Adds the inside voxels of a slab of blocks.
  void insert_slab(int bz, VoxelSet& inside) const {
    for (int by = 0; by < blocks_; ++by)
      for (int bx = 0; bx < blocks_; ++bx) {
        const Eigen::Vector3i low = kBlock * Eigen::Vector3i(bx, by, bz);
        const Eigen::Vector3i high =
            (low.array() + kBlock).cwiseMin(lines_.side()).matrix() - Eigen::Vector3i::Ones();
        if (near_[block_index(bx, by, bz)] || !insert_far_block(low, high, inside))
          insert_voxels(low, high, inside);
      }
  }

 private:
  std::size_t block_index(int bx, int by, int bz) const {
    return (static_cast<std::size_t>(bz) * static_cast<std::size_t>(blocks_) +
            static_cast<std::size_t>(by)) *
               static_cast<std::size_t>(blocks_) +
           static_cast<std::size_t>(bx);
  }

  double winding(int ix, int iy, int iz) const {
    return tree_.winding_number(lines_.center(ix, iy, iz));
  }

  void mark_blocks_near_surface() {
    const auto n = static_cast<std::size_t>(blocks_);
    near_.assign(n * n * n, 0);
    const double margin = lines_.side() > 1 ? lines_.centers[0][1] - lines_.centers[0][0] : 0.0;
    tree_.for_each_box([&](const Vec3& low, const Vec3& high) {
      std::array<IndexRange, 3> range;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        range[k] = indices_within(lines_.centers[k], low[axis] - margin, high[axis] + margin);
        if (range[k].empty()) return;
        range[k] = {range[k].first / kBlock, (range[k].last - 1) / kBlock + 1};
      }
      for (int bz = range[2].first; bz < range[2].last; ++bz)
        for (int by = range[1].first; by < range[1].last; ++by)
          for (int bx = range[0].first; bx < range[0].last; ++bx)
            near_[block_index(bx, by, bz)] = 1;
    });
  }

  /// Without surface in it, the winding number is a harmonic function of the block: where its
  /// corners are all clearly inside or all clearly outside, so is the rest.
  bool insert_far_block(const Eigen::Vector3i& low, const Eigen::Vector3i& high,
                        VoxelSet& inside) const {
    const bool is_inside = winding(low.x(), low.y(), low.z()) > 0.5;
    for (int corner = 0; corner < 8; ++corner) {
      const double w =
          winding((corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : low.y(),
                  (corner & 4) != 0 ? high.z() : low.z());
      if (is_inside ? w < 0.7 : w > 0.3) return false;
    }
    if (is_inside)
      for (int iz = low.z(); iz <= high.z(); ++iz)
        for (int iy = low.y(); iy <= high.y(); ++iy) inside.insert_run(low.x(), high.x(), iy, iz);
    return true;
  }

  void insert_voxels(const Eigen::Vector3i& low, const Eigen::Vector3i& high,
                     VoxelSet& inside) const {
    for (int iz = low.z(); iz <= high.z(); ++iz)
      for (int iy = low.y(); iy <= high.y(); ++iy)
        for (int ix = low.x(); ix <= high.x(); ++ix)
          if (winding(ix, iy, iz) > 0.5) inside.insert(ix, iy, iz);
  }

  const WindingTree& tree_;
  CenterLines lines_;
  int blocks_;
  std::vector<std::uint8_t> near_;  ///< per block: a triangle's box is within a voxel of it
};

}  // namespace

VoxelSet voxels_by_winding(const WindingTree& tree, const VoxelGrid& grid, int level) {
  VoxelSet inside(level);
  const WindingTest test(tree, grid, level);
  // Every slab of blocks is written by one thread.
  parallel_for(static_cast<std::size_t>(test.blocks()), 1,
               [&](std::size_t slab) { test.insert_slab(static_cast<int>(slab), inside); });
  return inside;
}

geometry::MassProperties voxel_mass(const VoxelSet& voxels, const VoxelGrid& grid) {
  const double s = grid.voxel_edge(voxels.level());
  const Vec3 origin = grid.origin + Vec3::Constant(0.5 * grid.edge);
  double count = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const VoxelIndex& index : voxels.morton_sorted()) {
    const Vec3 r = grid.voxel_center(voxels.level(), index) - origin;
    count += 1.0;
    first += r;
    second += r * r.transpose();
  }
  geometry::MassProperties mass;
  const double cell = s * s * s;
  mass.volume = count * cell;
  const Vec3 center = first / count;
  mass.center_of_mass = origin + center;
  // Each cube adds the integral of x x^T about its own centre.
  const Mat3 central = cell * (second - count * center * center.transpose() +
                               count * s * s / 12.0 * Mat3::Identity());
  mass.inertia = central.trace() * Mat3::Identity() - central;
  return mass;
}

double voxel_volume_error(const VoxelSet& voxels) {
  return 0.5 * static_cast<double>(voxels.surface().count()) / static_cast<double>(voxels.count());
}

}  // namespace gotai::voxel
